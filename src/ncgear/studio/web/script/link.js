// The connection to the server; it comes back by itself, and the server knows the page by its name.

const AGAIN_MS = 1000;

function createLink(onMessage, onState) {
  const state = { socket: null, closed: false };

  function pageName(anew) {
    if (anew || !sessionStorage.getItem("ncgear-page")) sessionStorage.setItem("ncgear-page", crypto.randomUUID());
    return sessionStorage.getItem("ncgear-page");
  }

  function connect(anew) {
    const address = new URL(`talk?page=${pageName(anew)}`, location.href);
    address.protocol = "ws:";
    state.socket = new WebSocket(address);
    state.socket.addEventListener("open", () => onState(true));
    state.socket.addEventListener("message", (event) => onMessage(JSON.parse(event.data)));
    state.socket.addEventListener("close", (event) => {
      onState(false);
      // A page that was duplicated has the name of the other one: it takes a name of its own.
      if (!state.closed) setTimeout(() => connect(event.code === 1013), AGAIN_MS);
    });
  }

  function send(message) {
    if (state.socket.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify(message));
  }

  connect(false);
  return { send };
}
