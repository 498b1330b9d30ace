// The connection to the server; it comes back by itself, and the server knows the page by its name.

const AGAIN_MS = 1000;

// The server ends a connection so when the page, duplicated with its name, goes on in another tab.
const TAKEN_OVER = 4001;

function pageName() {
  if (!sessionStorage.getItem("ncgear-page")) sessionStorage.setItem("ncgear-page", crypto.randomUUID());
  return sessionStorage.getItem("ncgear-page");
}

function createLink(onMessage, onState) {
  const state = { socket: null };

  function connect() {
    const address = new URL(`talk?page=${pageName()}`, location.href);
    address.protocol = "ws:";
    state.socket = new WebSocket(address);
    state.socket.addEventListener("open", () => onState(true));
    state.socket.addEventListener("message", (event) => onMessage(JSON.parse(event.data)));
    state.socket.addEventListener("close", (event) => {
      const taken = event.code === TAKEN_OVER;
      onState(false, taken);
      if (!taken) setTimeout(connect, AGAIN_MS);
    });
  }

  function send(message) {
    if (state.socket.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify(message));
  }

  connect();
  return { send };
}
