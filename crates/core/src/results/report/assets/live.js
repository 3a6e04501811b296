// For pages that `wythe view` serves: reloads the page when the files have changed, and keeps the choices of the user.

(function () {
  const NAME = "wythe view", EVERY = 1000;
  const stamp = "{{STAMP}}";
  const by = (id) => document.getElementById(id);
  const choices = ["colour", "magnification", "joints", "outlines", "mesh"].map(by).filter(Boolean);
  const frame = by("frame"), wall = by("view")?.wall;

  function keep() {
    if (!frame) return;
    const values = {};
    for (const of of choices) values[of.id] = of.type === "checkbox" ? of.checked : of.value;
    const follows = frame.value === frame.max;
    sessionStorage.setItem(NAME, JSON.stringify({ values, follows, frame: frame.value, scroll: scrollY, pose: wall && wall.pose() }));
  }

  function restore() {
    const kept = JSON.parse(sessionStorage.getItem(NAME));
    if (!kept || !frame) return;
    for (const of of choices) {
      if (!(of.id in kept.values)) continue;
      if (of.type === "checkbox") of.checked = kept.values[of.id];
      else of.value = kept.values[of.id];
      of.dispatchEvent(new Event(of.type === "range" ? "input" : "change"));
    }
    if (!kept.follows) {
      frame.value = kept.frame;
      frame.dispatchEvent(new Event("input"));
    }
    if (wall && kept.pose) wall.take(kept.pose);
    scrollTo(0, kept.scroll);
  }

  async function ask() {
    if (by("play")?.textContent === "Pause") return;
    const answer = await fetch("stamp").then((got) => got.text()).catch(() => stamp);
    if (answer === stamp) return;
    keep();
    location.reload();
  }

  restore();
  setInterval(ask, EVERY);
})();
