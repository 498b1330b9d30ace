"""One page of the studio: its requests, the text that it edits, and the answers and jobs that it is told of.

Messages are values of JSON. The page sends ``{"do": ..., ...}``: the methods of ``OpenPage`` with these names do them.
The page gets ``state`` (the text and everything that follows from it), the answers of ``answers.py`` with the number
``n`` of their text, ``job``, ``said``, ``lacking`` (keys that were emptied but must be given, with the faults without
them), and ``question`` where a person must decide on a save.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ncgear.design.reading.design_file import as_it_is
from ncgear.design.reading.text import has_train, shortened
from ncgear.design.rewritten import document_of
from ncgear.errors import WrongInput
from ncgear.studio.chains import Chains
from ncgear.studio.drafts import Draft, draft_left
from ncgear.studio.drawing import with_dropped
from ncgear.studio.editing import TextHistory, difference, edited, in_line_ends_of, lacking
from ncgear.studio.form import form
from ncgear.studio.jobs import COMMANDS, Job, require_command
from ncgear.studio.messages import read_message, words_of
from ncgear.studio.on_disk import LARGEST_MB, DesignOnDisk, NotSaved, design_on_disk, kept_words, require_same_place

MOST_CHANGES = 200
"""Most keys that one message changes; a remedy changes three."""

BETWEEN_S = 0.05
"""Time between two questions during a drag: 20 pictures a second leave the processor free for the teeth."""

RESTS_S = 0.3
"""Time without a move after which the dragged value is kept as a draft, in case the studio is killed."""

AGAIN_S = 1.0
"""Time after which work is told again to end: a page that comes back waits for it, and libraries may miss a signal."""

ACTIONS = ("change", "set", "keep", "text", "undo", "redo", "save", "anew", "run", "cancel", "adopt", "point")
"""Requests of a page: methods of ``OpenPage``."""

MOST_JOBS = 2
"""Most commands that run at once; each may use all cores."""


class OpenPage:
    """The state of one page; it outlives a connection, so a page that is loaded again continues where it was."""

    def __init__(self, path: Path, out: Path, chains: Chains | None = None) -> None:
        self._opened_as = path
        self.file: DesignOnDisk = design_on_disk(path)
        self._notices = kept_words(self.file.kept)
        draft = draft_left(self.file)
        if draft is not None:
            self.file = draft.file
            self._notices += (DRAFT_FOUND,)
        self.draft = draft or Draft(self.file, self.file.text)
        self._draft_refused = False
        self._asked_about: DesignOnDisk | None = None
        self.out = out
        self.history = TextHistory(self.file.text).kept(self.draft.text)
        self.changes: dict[str, Any] = {}
        self.number = self._shown = 0
        self.jobs: dict[int, Job] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._send: Callable[[str], Awaitable[None]] | None = None
        self._chains = chains if chains is not None else Chains()
        self._chains.told = self._tell
        self._changed = asyncio.Event()
        self._asking = asyncio.Lock()
        self._leaving = asyncio.Lock()

    async def connected(self, send: Callable[[str], Awaitable[None]]) -> None:
        """Tell everything to a page that has just connected; it replaces an earlier connection."""
        # A page that is loaded again connects while its last connection still ends, which would end the new work too.
        async with self._leaving:
            if self._send is None:
                self._spawn(self._follow())
            self._send = send
            await self._let_go()
            notices, self._notices = self._notices, ()
        await self._tried(self._show())
        if notices:
            await self._say(" ".join(notices))

    async def disconnected(self, send: Callable[[str], Awaitable[None]] | None) -> None:
        """End the processes of the page, unless another connection has taken it over; commands continue."""
        async with self._leaving:
            if self._send is not send:
                return
            self._send = None
            while tasks := list(self._tasks):
                async with self._asking:
                    # A process that is just being started would be lost if its start were cancelled.
                    for task in tasks:
                        task.cancel()
                await asyncio.wait(tasks, timeout=AGAIN_S)
            await self._chains.close()
            await self._let_go()

    async def _let_go(self) -> None:
        """Make a step of the history from the last drag, if the connection ended before the drag was finished."""
        if self.changes:
            text = await asyncio.to_thread(self._dragged_to)
            self.history, self.changes = self.history.kept(text), {}
            await asyncio.to_thread(self._draft_problem, text)

    async def closed(self) -> None:
        """End everything, commands as well."""
        await asyncio.gather(*(job.cancel() for job in self.jobs.values() if job.status is None))
        await self.disconnected(self._send)
        self.draft.let_go()

    async def hear(self, data: str | bytes) -> None:
        """Do what a message asks for; if that fails, the error is told, and nothing changes."""
        if not await self._tried(self._done(data)):
            await self._tried(self._show())

    async def _tried(self, work: Awaitable[None]) -> bool:
        """Whether work has been done; any fault is told, and the conversation continues."""
        try:
            await work
        except Exception as error:
            await self._say(words_of(error))
            return False
        return True

    async def _done(self, data: str | bytes) -> None:
        message = read_message(data)
        name = message.get("do")
        if name not in ACTIONS:
            asked = f"{shortened(str(name))!r} asked for" if "do" in message else "nothing to do asked for"
            raise WrongInput(f"{asked}; {', '.join(ACTIONS)} are right", key="do")
        await getattr(self, name)(message)

    async def change(self, message: Mapping[str, Any]) -> None:
        """``changes`` by key, while something is dragged: answers follow, the history does not."""
        self.changes |= _changes_of(message)
        self._changed.set()

    async def set(self, message: Mapping[str, Any]) -> None:
        """``changes`` by key, as one step of the history."""
        self.changes |= _changes_of(message)
        await self.keep(message)

    async def keep(self, _: Mapping[str, Any]) -> None:
        """Make one step of the history from the changes since the last step."""
        changes, self.changes = self.changes, {}
        self._changed.clear()
        if not changes:
            await self._show()
            return
        emptied = await asyncio.to_thread(lacking, self.history.now, changes, self.file.path)
        if remaining := {key: value for key, value in changes.items() if key not in emptied}:
            self.history = self.history.kept(await asyncio.to_thread(edited, self.history.now, remaining))
        if remaining or self.number != self._shown:
            await self._show()
        if emptied:
            await self._tell(json.dumps({"is": "lacking", "content": emptied}))

    async def text(self, message: Mapping[str, Any]) -> None:
        """The whole ``text``, typed by hand."""
        text = message.get("text")
        if not isinstance(text, str) or len(text.encode()) > LARGEST_MB * 1_000_000:
            raise WrongInput(f"a text of at most {LARGEST_MB} MB is right", key="text")
        before = self.history.now
        await self._step(self.history.kept(await asyncio.to_thread(in_line_ends_of, before, text)))

    async def dropped(self, name: str, content: bytes) -> None:
        """Use a drawing that was dropped onto the page as the pitch curve, as one step of the history."""
        found = await asyncio.to_thread(with_dropped, self.history.now, self.file.path, name, content)
        await self._step(self.history.kept(found[0]))
        await self._say(f"{found[1]} stands beside the design, and is its pitch curve; Undo takes the former one.")

    async def undo(self, _: Mapping[str, Any]) -> None:
        """Go one step back in the history."""
        await self._step(self.history.undone())

    async def redo(self, _: Mapping[str, Any]) -> None:
        """Go one step forward in the history."""
        await self._step(self.history.redone())

    async def save(self, message: Mapping[str, Any]) -> None:
        """Save into the design file; with ``over`` replace the version that the last question has shown."""
        text = self.history.now
        asked_about, self._asked_about = self._asked_about, None
        over = asked_about if message.get("over") is True else None
        file = over or self.file
        try:
            await asyncio.to_thread(require_same_place, file, self._opened_as)
            self.file = await asyncio.to_thread(file.saved, text, protected_too=over is not None)
        except NotSaved as problem:
            self._asked_about = problem.there
            await self._say(str(problem))
            await self._show()
            there = difference(problem.there.text, text, problem.there.path.name, "on disk")
            question = {"problem": f"{self._opened_as.name} {problem.problem}", "difference": there}
            await self._tell(json.dumps({"is": "question", "content": question}))
            return
        await self._say(" ".join((f"saved {self.file.path.name}", *kept_words(self.file.kept))))
        await self._show()

    async def anew(self, _: Mapping[str, Any]) -> None:
        """Open the file on the disk again, as one step of the history."""
        self.file = await asyncio.to_thread(design_on_disk, self._opened_as)
        for words in kept_words(self.file.kept):
            await self._say(words)
        await self._step(self.history.kept(self.file.text))

    async def run(self, message: Mapping[str, Any]) -> None:
        """Run a ``command`` on the text that is shown."""
        await self._run(message.get("command"), self.history.now)

    async def cancel(self, message: Mapping[str, Any]) -> None:
        """Cancel the command of a ``job``."""
        job = self._job(message)
        await job.cancel()

    async def adopt(self, message: Mapping[str, Any]) -> None:
        """Take over the design that a ``job`` has found; for whole machines ``design`` is the name of one machine."""
        job = self._job(message)
        found = sorted(job.folder.glob("*-optimized.yaml")) if job.name == "optimize" and job.status == 0 else []
        names = [machine["name"] for machine in _machines_of(job).get("machines", [])]
        if message.get("design") in names:
            found = [job.folder / f"{message['design']}.yaml"]
        if not found:
            raise WrongInput("has found no design", key="job")
        text = design_on_disk(found[0]).text
        await self._step(self.history.kept(text))

    async def point(self, message: Mapping[str, Any]) -> None:
        """Look for the best law at ``power_w``, the power of a point of the frontier."""
        power = message.get("power_w")
        if not isinstance(power, int | float) or isinstance(power, bool):
            raise WrongInput("a number is right", key="power_w")
        wanted = {"optimize.goal": "least_acceleration", "optimize.limits.peak_power_w": float(power)}
        await self._run("optimize", await asyncio.to_thread(edited, self.history.now, wanted))

    async def _run(self, name: Any, text: str) -> None:
        command = require_command(name)
        loaded = await asyncio.to_thread(as_it_is, text, self.file.path)
        design = loaded.source.data["name"]
        folder = self.out / f"{design}{command.out}"
        for job in running_jobs.values():
            if job.folder == folder:
                said = f"{COMMANDS[job.name].words} runs already and writes into {folder.name}"
                raise WrongInput(f"{said}; wait for it, or cancel it", key="command")
        running = [COMMANDS[job.name].words for job in self.jobs.values() if job.status is None]
        if len(running) >= MOST_JOBS:
            raise WrongInput(f"{' and '.join(running)} run already; wait for one, or cancel it", key="command")
        job = Job(len(self.jobs) + 1, str(name), text, design, folder, self._job_told)
        self.jobs[job.number] = job
        task = asyncio.create_task(self._carried_out(job))
        running_jobs[task] = job
        task.add_done_callback(running_jobs.pop)
        self._job_told(job)

    async def _carried_out(self, job: Job) -> None:
        try:
            await job.run(self.out, self.file.path)
        except Exception as error:
            job.lines.append(words_of(error))
            job.status = getattr(error, "exit_status", 2)
            self._job_told(job)

    def _job(self, message: Mapping[str, Any]) -> Job:
        number = message.get("job")
        job = self.jobs.get(number) if isinstance(number, int) else None
        if job is None:
            raise WrongInput("no such job", key="job")
        return job

    def _job_told(self, job: Job) -> None:
        self._spawn(self._tell(json.dumps({"is": "job", "content": self._plain(job)})))

    def _plain(self, job: Job) -> dict[str, Any]:
        """A job for the page; when it is done, with its files, points of a frontier and whole machines."""
        content = job.as_plain
        if found := _machines_of(job):
            content["machines"] = found
        if job.status == 0:
            content["files"] = _files_of(job.folder, self.out)
            if job.name == "frontier":
                # If the file has been removed, there is no picture of it.
                with suppress(OSError, ValueError):
                    content["frontier"] = json.loads((job.folder / "frontier.json").read_text(encoding="utf-8"))
        return content

    def _spawn(self, work: Any) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _step(self, history: TextHistory) -> None:
        self.changes = {}
        self._changed.clear()
        self.history = history
        await self._show()

    async def _follow(self) -> None:
        """Ask for the answers to a drag: only for the newest place, however fast the hand is."""
        while True:
            try:
                # Not wait_for: before Python 3.12 it loses a cancel that comes in the same turn as the change.
                async with asyncio.timeout(RESTS_S if self.changes else None):
                    await self._changed.wait()
            except TimeoutError:
                await self._tried(self._rest())
            await self._tried(self._ask())
            await asyncio.sleep(BETWEEN_S)

    async def _rest(self) -> None:
        """Keep the place of a resting hand as a draft, and wait for the next move."""
        async with self._asking:
            # A step of the history that comes in the meantime writes its own draft after this one.
            if self.changes and (problem := await asyncio.to_thread(lambda: self._draft_problem(self._dragged_to()))):
                await self._say(problem)
        await self._changed.wait()

    def _dragged_to(self) -> str:
        """The text with the dragged values; without them where they have no place, which the answers say."""
        with suppress(WrongInput):
            return edited(self.history.now, dict(self.changes))
        return self.history.now

    async def _ask(self) -> None:
        async with self._asking:
            self._changed.clear()
            # A step of the history with all changes may have come in the meantime.
            if changes := dict(self.changes):
                self.number += 1
                await self._tell(json.dumps({"is": "asked", "n": self.number, "content": changes}))
                await self._chains.ask(self.number, self.history.now, changes, str(self.file.path))

    async def _show(self) -> None:
        """Tell the page the text and everything that follows from it alone, and ask for the answers."""
        async with self._asking:
            self.number = self._shown = self.number + 1
            content = await asyncio.to_thread(self._state)
            if problem := await asyncio.to_thread(self._draft_problem, content["text"]):
                await self._say(problem)
            await self._tell(json.dumps({"is": "state", "n": self.number, "content": content}))
            await self._chains.ask(self.number, content["text"], {}, str(self.file.path))

    def _state(self) -> dict[str, Any]:
        text, saved = self.history.now, self.file.text
        try:
            data = document_of(text).data
        except WrongInput:
            data = None
        rows = form(data) if isinstance(data, dict) else None
        return {
            "file": self.file.path.name,
            "text": text,
            "form": rows,
            "saved": text == saved,
            "difference": difference(saved, text, self.file.path.name),
            "undo": len(self.history.past),
            "redo": len(self.history.future),
            "commands": [name for name, command in COMMANDS.items() if command.takes_trains or not has_train(text)],
            "jobs": [self._plain(job) for job in self.jobs.values()],
        }

    def _draft_problem(self, text: str) -> str:
        """Keep the unsaved text where it survives a killed studio; the reason why it cannot be kept, told once."""
        try:
            self.draft.follow(self.file, text)
            self._draft_refused = False
        except OSError as error:
            said, self._draft_refused = self._draft_refused, True
            reason = error.strerror or str(error)
            return "" if said else f"unsaved changes are lost when the studio ends: no draft can be written ({reason})"
        return ""

    async def _say(self, text: str) -> None:
        await self._tell(json.dumps({"is": "said", "content": text}))

    async def _tell(self, text: str) -> None:
        if self._send is not None:
            await self._send(text)


running_jobs: dict[asyncio.Task[None], Job] = {}
"""Running commands of all pages; asyncio itself keeps no task alive."""


DRAFT_FOUND = "Changes that were not saved when the studio ended are here again; Undo leads back to the file."


def _changes_of(message: Mapping[str, Any]) -> dict[str, Any]:
    changes = message.get("changes")
    if not isinstance(changes, dict) or not 0 < len(changes) <= MOST_CHANGES:
        raise WrongInput(f"1 to {MOST_CHANGES} keys with their values are right", key="changes")
    return changes


def _machines_of(job: Job) -> dict[str, Any]:
    """The whole machines that a job has found, also if it was cancelled; empty where there are none."""
    if job.name != "design" or job.status is None or not (job.status == 0 or job.cancelled):
        return {}
    # If the file has been removed, there are no machines.
    with suppress(OSError, ValueError):
        path = job.folder / "machines.json"
        if path.stat().st_mtime >= job.begun_s:
            return json.loads(path.read_text(encoding="utf-8"))
    return {}


def _files_of(folder: Path, out: Path) -> list[str]:
    """The files of a folder, by their paths from the export folder, without hidden files and hidden folders."""
    places = sorted(place for place in folder.rglob("*") if place.is_file())
    shown = [place for place in places if not any(part.startswith(".") for part in place.relative_to(folder).parts)]
    return [place.relative_to(out).as_posix() for place in shown]
