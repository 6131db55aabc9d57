// Plays the film of a flight: its images, map and figures, and a line through the page's plots.
const film = JSON.parse(document.getElementById("film").textContent);
const [play, seek, clock, map] = ["play", "seek", "clock", "map"].map((id) => document.getElementById(id));
const screens = ["flow", "sectors"].map((name) => [document.getElementById(name), film[name]]);
const ribbon = document.querySelector(".sectors canvas");
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
const pairs = (flat) => Array.from({ length: flat.length / 2 }, (_, i) => [flat[2 * i], flat[2 * i + 1]]);
const path = pairs(film.at);
let shown = film.shown;
// The animation clock's time at which frame 0 was, or would have been, shown; null while paused.
let begun = null;

// A cleared canvas at the screen's resolution, drawn on in CSS pixels, with its width and height in these.
function cleared(canvas) {
  const [width, height, dense] = [canvas.clientWidth, canvas.clientHeight, devicePixelRatio];
  [canvas.width, canvas.height] = [Math.round(width * dense), Math.round(height * dense)];
  const context = canvas.getContext("2d");
  context.scale(dense, dense);
  return [context, width, height];
}

function line(context, points, colour, width, closed) {
  context.beginPath();
  points.forEach(([x, y]) => context.lineTo(x, y));
  if (closed) context.closePath();
  [context.strokeStyle, context.lineWidth, context.lineJoin] = [colour, width, "round"];
  context.stroke();
}

function drawMap(index) {
  const [context, width, height] = cleared(map);
  const { colours, times } = film;
  const [scale, [right, ahead]] = [height / film.span, path[index]];
  const off = ([x, y]) => [film.vehicle[0] * width + scale * x, film.vehicle[1] * height - scale * y];
  const place = ([x, y]) => off([x - right, y - ahead]);
  context.fillStyle = colours.background;
  context.fillRect(0, 0, width, height);
  line(context, pairs(film.middle).map(place), colours.middle, 1);
  line(context, [[right - film.span, film.goal], [right + film.span, film.goal]].map(place), colours.goal, 2);
  for (const shape of film.shapes) {
    context.fillStyle = colours.solid;
    if (shape.length === 3) {
      context.beginPath();
      context.arc(...place(shape), Math.max(scale * shape[2], 1), 0, 7);
      context.fill();
    } else {
      line(context, pairs(shape).map(place), colours.solid, 1.5, true);
      context.fill();
    }
  }
  line(context, path.slice(0, index + 1).map(place), colours.path, 2);
  for (const [x, y, radius, time] of film.rings[index]) {
    context.beginPath();
    context.arc(...off([x, y]), Math.max(scale * radius, 2), 0, 7);
    [context.strokeStyle, context.lineWidth] = [times[time], 1.2];
    context.stroke();
  }
  line(context, [[0, 0], ...pairs(film.arc[index])].map(off), colours.arc, 3.5);
  context.save();
  context.translate(...off([0, 0]));
  context.rotate(film.nose[index]);
  context.beginPath();
  for (const [x, y] of [[0, -12], [8, 8], [0, 4], [-8, 8]]) context.lineTo(x, y);
  context.fillStyle = colours.vehicle;
  context.fill();
  context.restore();
  line(context, [[14, height - 14], [14 + 20 * scale, height - 14]], colours.scale, 2);
  context.fillStyle = colours.scale;
  context.font = "12px system-ui, sans-serif";
  context.fillText("20 m", 14, height - 20);
}

function drawRibbon(index) {
  const [context, width] = cleared(ribbon);
  const scale = width / Number(screens[1][0].getAttribute("width"));
  const sides = pairs(film.ribbon[index]).map(([x, y]) => [scale * x, scale * y]);
  for (let i = 0; i + 1 < sides.length; i += 2) {
    const [left, right] = [sides[i], sides[i + 1]];
    if (i > 0) {
      context.beginPath();
      for (const [x, y] of [sides[i - 2], left, right, sides[i - 1]]) context.lineTo(x, y);
      context.fillStyle = film.colours.arc;
      context.globalAlpha = 0.4;
      context.fill();
      context.globalAlpha = 1;
    }
    line(context, [left, right], film.colours.arc, 2);
  }
}

function draw() {
  drawMap(shown);
  drawRibbon(shown);
}

function show(index) {
  shown = index;
  for (const [screen, pictures] of screens) screen.src = pictures[index];
  draw();
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
addEventListener("resize", draw);
const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
show(still ? shown : 0);
run(!still);
