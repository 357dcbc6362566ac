// Where the page stands in another one that asks for it, such as a notebook: the map alone, whose point is told and moved
// from there.

if (window.parent !== window) {
  const tell = (message) => window.parent.postMessage({ ptmcad: message }, "*");
  let quiet = true; // until somebody asks, and while the point is moved from outside
  document.addEventListener("probe", ({ detail }) => { if (!quiet) tell({ point: detail }); });
  window.addEventListener("message", ({ source, data }) => {
    if (source !== window.parent || !data || !data.ptmcad) return;
    const { embedded, point } = data.ptmcad;
    if (embedded && !document.documentElement.classList.contains("embedded")) {
      document.documentElement.classList.add("embedded");
      new ResizeObserver(() => tell({ height: document.body.offsetHeight })).observe(document.body);
    }
    if (point && live.probe) {
      quiet = true;
      moveProbe(shareOf(point));
    } else if (embedded && live.probe) tell({ point: pointOf(live.share) });
    quiet = false;
  });
  tell({ ready: true });
}
