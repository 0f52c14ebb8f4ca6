// Buttons, the slider and the keyboard.

class Panel {
  constructor(root, world, overlay, playback, charts, data) {
    Object.assign(this, { root, world, overlay, playback, charts, data });
    this.find = (name) => root.querySelector(`[data-is="${name}"]`);
    this.slider = this.find("slider");
    this.buttons();
    this.choices();
    this.marks();
    root.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.marks()).observe(this.slider);
  }

  buttons() {
    const { playback } = this;
    this.find("play").addEventListener("click", () => this.toggle());
    this.find("before").addEventListener("click", () => this.jump(-1));
    this.find("after").addEventListener("click", () => this.jump(1));
    this.slider.addEventListener("input", () => playback.seek(playback.toTime((this.slider.value / this.slider.max) * playback.length)));
    for (const button of this.root.querySelectorAll("[data-view]")) {
      button.addEventListener("click", () => this.world.look(new THREE.Vector3(...JSON.parse(button.dataset.view)).normalize()));
    }
    this.find("fit").addEventListener("click", () => this.world.look(this.world.firstDirection()));
  }

  choices() {
    const { world, playback } = this;
    const on = (name, change) => this.find(name).addEventListener("change", (event) => change(event.target));
    on("speed", (choice) => (playback.speed = Number(choice.value)));
    on("slow", (choice) => {
      playback.setSlow(choice.checked);
      this.marks();
    });
    on("trails", (choice) => (world.show.trails = choice.checked));
    on("forces", (choice) => (world.show.forces = choice.checked));
    on("names", (choice) => (this.overlay.labels = choice.checked));
    on("arrows", (choice) => (world.rootArrows = choice.value === "root"));
    on("follow", (choice) => world.follow(choice.value || null));
    on("zoom", (choice) => this.zoomCharts(choice.checked));
    this.find("names").checked = this.overlay.labels;
    this.find("slow").disabled = playbackKnots(playback.begin, playback.end, playback.touches, true).length < 3;
  }

  toggle() {
    if (this.playback.playing) this.playback.playing = false;
    else this.playback.play();
  }

  /** To the contact before or after the time that is shown, a little before its onset. */
  jump(direction) {
    const { playback } = this;
    const onsets = this.data.touches.map(([begin, end]) => Math.max(playback.begin, begin - BESIDE * (end - begin)));
    const least = 1e-9 * (playback.end - playback.begin);
    const there = onsets.filter((t) => (direction > 0 ? t > playback.time + least : t < playback.time - least));
    const none = direction > 0 ? playback.end : playback.begin;
    playback.seek(there.length ? there[direction > 0 ? 0 : there.length - 1] : none);
  }

  key(event) {
    if (event.target.matches("select, input:not([type=range])")) return;
    const { playback } = this;
    const step = (share) => playback.seek(playback.toTime(playback.toShown(playback.time) + share * playback.length));
    const keys = {
      " ": () => this.toggle(),
      ArrowLeft: () => step(-0.005),
      ArrowRight: () => step(0.005),
      PageUp: () => this.jump(-1),
      PageDown: () => this.jump(1),
      Home: () => playback.seek(playback.begin),
      End: () => playback.seek(playback.end),
    };
    if (!keys[event.key] || (event.key === " " && event.target.matches("button"))) return;
    event.preventDefault();
    keys[event.key]();
  }

  /** The contacts on the slider. */
  marks() {
    const canvas = this.find("marks");
    const width = (canvas.width = canvas.clientWidth);
    const pen = canvas.getContext("2d");
    pen.clearRect(0, 0, width, canvas.height);
    pen.fillStyle = colorOf(1);
    const thumb = 8; // half of the slider's thumb: its middle never reaches the ends
    const place = (t) => thumb + (this.playback.toShown(t) / this.playback.length) * (width - 2 * thumb);
    for (const [begin, end] of this.data.touches) {
      const left = place(begin);
      pen.fillRect(left, 0, Math.max(1.5, place(end) - left), canvas.height);
    }
  }

  zoomCharts(near) {
    this.near = near;
    if (!near) this.charts.setRange(...this.charts.whole);
    this.zoomed = null;
  }

  /** Charts about the contact that is nearest to the time shown. */
  followContact() {
    if (!this.near || this.data.touches.length === 0) return;
    const t = this.playback.time;
    const away = ([begin, end]) => Math.max(begin - t, t - end, 0);
    const nearest = this.data.touches.reduce((best, one) => (away(one) < away(best) ? one : best));
    if (nearest === this.zoomed) return;
    this.zoomed = nearest;
    const air = 0.6 * (nearest[1] - nearest[0]);
    this.charts.setRange(nearest[0] - air, nearest[1] + air);
  }

  update() {
    const { playback } = this;
    this.slider.value = (playback.toShown(playback.time) / playback.length) * this.slider.max;
    this.set("play", playback.playing ? "❚❚" : "▶", playback.playing ? "pause" : "play");
    const span = playback.end - playback.begin;
    const digits = Math.min(15, Math.max(3, Math.ceil(4 - Math.log10(span))));
    this.set("time", `t = ${playback.time.toFixed(digits)} s`);
    this.set("rate", rateText(playback.rate()));
    this.followContact();
  }

  set(name, text, label) {
    const element = this.find(name);
    if (element.textContent === text) return;
    element.textContent = text;
    if (label) element.setAttribute("aria-label", label);
  }
}

/** 0.004 is "250 times slower than real". */
function rateText(rate) {
  if (Math.abs(rate - 1) < 0.02) return "real time";
  const factor = rate < 1 ? 1 / rate : rate;
  const told = factor < 10 ? factor.toFixed(1) : factor < 1e5 ? Math.round(factor).toLocaleString("en") : factor.toExponential(1).replace("e+", "e");
  return `${told}× ${rate < 1 ? "slower" : "faster"} than real`;
}
