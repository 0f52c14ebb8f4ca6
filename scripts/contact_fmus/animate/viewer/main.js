// Puts the parts together and draws frame after frame while something changes.

const TOO_SLOW = 1 / 32; // s a frame; above it the picture gets fewer points
const SETTLING = 15; // frames that may take long: the first are slow on any machine
const FEWEST_POINTS = 0.5; // of those of the screen in each direction

class Animation {
  constructor(data) {
    const stage = document.querySelector("[data-is=stage]");
    this.stage = stage;
    const times = decodeNumbers(data.time);
    this.playback = new Playback(times, data.touches);
    this.world = new World(stage.querySelector("canvas"), data, this.playback);
    this.overlay = new Overlay(stage.querySelector("canvas:last-of-type"), this.world);
    this.charts = new Charts(document.querySelector(".charts"), data, { hovers: false, pick: (t) => this.playback.seek(t) });
    this.panel = new Panel(document.body, this.world, this.overlay, this.playback, this.charts, data);
    this.frames = 0;
    this.quality = 1;
    this.slowness = 0;
    this.watched = 0;
    this.last = null;
    new ResizeObserver(() => this.resize()).observe(stage);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.world.restyle();
      this.panel.marks();
    });
    this.resize();
    this.world.look(this.world.firstDirection());
    requestAnimationFrame((now) => this.frame(now));
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (!width || !height) return;
    this.world.resize(width, height, this.quality * Math.min(2, window.devicePixelRatio || 1));
    this.overlay.resize(width, height);
    this.draw();
  }

  frame(now) {
    const passed = this.last === null ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.playback.playing) this.adapt(passed);
    this.playback.advance(passed);
    this.draw();
    requestAnimationFrame((next) => this.frame(next));
  }

  draw() {
    if (this.flat) return;
    this.world.draw();
    this.overlay.draw();
    this.charts.setCursor(this.playback.time);
    this.panel.update();
    this.frames += 1;
  }

  /** Fewer points where frames take too long, for good: going to and fro would be seen. */
  adapt(passed) {
    this.watched += 1;
    if (this.watched < SETTLING) return;
    this.slowness = 0.9 * this.slowness + 0.1 * passed;
    if (this.slowness < TOO_SLOW || this.quality <= FEWEST_POINTS) return;
    this.quality = Math.max(FEWEST_POINTS, 0.8 * this.quality);
    this.slowness = this.watched = 0;
    this.resize();
  }

  // what tests and other scripts may use

  seek(t) {
    this.playback.playing = false;
    this.playback.seek(t);
    this.draw();
  }

  play() {
    this.playback.play();
  }

  pause() {
    this.playback.playing = false;
  }

  get time() {
    return this.playback.time;
  }

  /** Pixels in the picture of a body's centre. */
  project(name) {
    return this.world.toPixels(this.world.bodies.find((body) => body.name === name).group.position);
  }

  /** In m of the world, the angle in degrees from the lower to the upper edge, the picture's size in pixels. */
  camera() {
    const { camera, controls, scale, origin, width, height } = this.world;
    const inWorld = (place) => place.toArray().map((one, k) => one * scale + origin[k]);
    return { position: inWorld(camera.position), target: inWorld(controls.target), up: camera.up.toArray(), angle: camera.fov, width, height };
  }

  /** Only these bodies, at most three: red, green and blue, without light, added where they cover each other.
   * drawAgain() goes back. */
  drawFlat(names) {
    this.flat = true;
    const { world } = this;
    world.draw();
    const colors = [0xff0000, 0x00ff00, 0x0000ff];
    const kept = new Map();
    world.scene.traverse((one) => kept.set(one, one.visible));
    world.scene.traverse((one) => (one.visible = one.type === "Scene" || one.type === "Group"));
    names.forEach((name, k) => {
      const { mesh } = world.bodies.find((body) => body.name === name);
      mesh.visible = true;
      mesh.material = new THREE.MeshBasicMaterial({ color: colors[k], blending: THREE.AdditiveBlending, depthTest: false, transparent: true });
    });
    for (const contact of world.contacts) for (const force of contact.forces) force.arrow.arrow.visible = false;
    world.scene.background = new THREE.Color(0);
    world.renderer.setPixelRatio(1);
    world.renderer.render(world.scene, world.camera);
    this.stage.classList.add("flat");
    kept.forEach((visible, one) => (one.visible = visible));
    for (const body of world.bodies) [body.mesh.material] = body.materials;
    world.scene.background = world.background;
  }

  drawAgain() {
    this.flat = false;
    this.stage.classList.remove("flat");
    this.resize();
  }
}

try {
  window.contactAnimation = new Animation(JSON.parse(document.getElementById("data").textContent));
} catch (error) {
  const note = document.querySelector("[data-is=note]");
  note.textContent = `This browser cannot draw in three dimensions (${error.message}).`;
  note.hidden = false;
  throw error;
}
