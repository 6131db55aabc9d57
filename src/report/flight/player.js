// Plays the film of a flight: its pictures, its figures, and a line through the curves of the page.
const film = JSON.parse(document.getElementById("film").textContent);
const screens = ["camera", "danger", "map"].map((name) => [document.getElementById(name), film[name]]);
const [play, seek, clock] = ["play", "seek", "clock"].map((id) => document.getElementById(id));
const figures = [...document.querySelectorAll("#readout .tile")];
const names = figures.map((figure) => figure.querySelector("span").textContent);
const cursors = [...document.querySelectorAll("svg[data-axis]")].map((plot) => {
  const [left, right, from, to] = plot.dataset.axis.split(" ").map(Number);
  const line = document.createElementNS(plot.namespaceURI, "line");
  line.setAttribute("class", "cursor");
  line.setAttribute("y1", 24);
  line.setAttribute("y2", plot.viewBox.baseVal.height - 24);
  plot.append(line);
  return (time) => {
    const x = left + ((right - left) * (time - from)) / (to - from);
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
  };
});
const count = film.time.length;
let shown = film.shown;
// When the frame 0 was or would have been shown, in the clock of the animation; none while it stands.
let begun = null;

function show(index) {
  shown = index;
  for (const [screen, pictures] of screens) screen.src = pictures[index];
  figures.forEach((figure, i) => (figure.querySelector("b").textContent = film.text[index][i]));
  cursors.forEach((move) => move(film.time[index]));
  const time = `${film.time[index].toFixed(1)} s`;
  clock.textContent = time;
  seek.value = index;
  seek.setAttribute("aria-valuetext", [time, ...film.text[index].map((text, i) => `${names[i]} ${text}`)].join("; "));
}

function tick(now) {
  if (begun === null) return;
  let index = Math.floor((now - begun) / 1000 / film.interval);
  if (index < 0 || index >= count) {
    begun = now;
    index = 0;
  }
  if (index !== shown) show(index);
  requestAnimationFrame(tick);
}

function run(running) {
  if (running === (begun !== null)) return;
  begun = running ? performance.now() - shown * film.interval * 1000 : null;
  play.textContent = running ? "Pause" : "Play";
  if (running) requestAnimationFrame(tick);
}

function go(index) {
  run(false);
  show(Math.min(Math.max(index, 0), count - 1));
}

play.addEventListener("click", () => run(begun === null));
seek.addEventListener("input", () => go(Number(seek.value)));
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // A button is pressed with the space bar, and a slider moved with the arrows, by the browser.
  const own = event.target.closest("button, a, input");
  if (event.key === " " && own !== play) run(begun === null);
  else if (event.key === "ArrowLeft" && own !== seek) go(shown - 1);
  else if (event.key === "ArrowRight" && own !== seek) go(shown + 1);
  else return;
  event.preventDefault();
});
const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
show(still ? shown : 0);
run(!still);
