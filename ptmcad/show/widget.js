// A map in a notebook: the report's page in a frame of its own that may run its script and nothing else; its point goes to
// Python where it rests, and comes from there.

const REST = 150; // milliseconds
const TALLEST = 720; // pixels; what is longer is scrolled beside the map

export default {
  render({ model, el }) {
    const names = model.get("_names");
    const frame = document.createElement("iframe");
    frame.setAttribute("sandbox", "allow-scripts");
    frame.title = "Region map";
    frame.style.cssText = "width: 100%; height: 40rem; border: 0; display: block;";
    const answer = document.createElement("pre");
    answer.className = "ptmcad-answer";
    answer.setAttribute("role", "status");
    answer.style.cssText = "overflow: auto; max-height: 20rem; font-size: 12px;";
    const show = () => { answer.textContent = model.get("_answer"); };
    const send = (message) => frame.contentWindow.postMessage({ ptmcad: message }, "*");
    const place = () => {
      const point = model.get("point");
      return names.every((name) => name in point) ? names.map((name) => point[name]) : null;
    };
    let told = ""; // what the page itself has said last
    let waiting = 0;
    const heard = ({ source, data }) => {
      if (source !== frame.contentWindow || !data || !data.ptmcad) return;
      const { ready, height, point } = data.ptmcad;
      if (ready) send({ embedded: true, point: place() });
      if (height > 0) frame.style.height = `${Math.ceil(Math.min(height, TALLEST))}px`;
      if (Array.isArray(point) && point.length === names.length && point.every(Number.isFinite)) {
        clearTimeout(waiting);
        waiting = setTimeout(() => {
          told = JSON.stringify(point);
          model.set("point", Object.fromEntries(names.map((name, k) => [name, point[k]])));
          model.save_changes();
        }, REST);
      }
    };
    const moved = () => {
      const point = place();
      if (point && JSON.stringify(point) !== told) send({ point });
    };
    window.addEventListener("message", heard);
    model.on("change:point", moved);
    model.on("change:_answer", show);
    frame.srcdoc = model.get("_page");
    el.append(frame, answer);
    show();
    return () => {
      clearTimeout(waiting);
      window.removeEventListener("message", heard);
      model.off("change:point", moved);
      model.off("change:_answer", show);
    };
  },
};
