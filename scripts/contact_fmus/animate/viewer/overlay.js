// What is written over the picture: names, rings around bodies too small to be seen, forces in numbers, the axes.

const SMALL_BODY = 5; // pixels; a body with a smaller radius gets a ring
const FONT = "600 12px system-ui, sans-serif";
const NAMED = [-0.85, -0.5, 0, 0.5, 0.85].flatMap((x) => [-0.85, -0.5, 0, 0.5, 0.85].map((z) => [x, z])); // of a floor
const FIRST_LABELS = 12; // bodies with names; more would cover the picture

class Overlay {
  constructor(canvas, world) {
    this.canvas = canvas;
    this.world = world;
    this.labels = world.bodies.length <= FIRST_LABELS;
  }

  resize(width, height) {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.pen = this.canvas.getContext("2d");
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  draw() {
    const { pen, world } = this;
    pen.clearRect(0, 0, world.width, world.height);
    for (const body of world.bodies) this.drawBody(body);
    if (world.show.forces) this.drawForces();
    this.drawAxes();
  }

  drawBody(body) {
    const { pen, world } = this;
    const center = world.toPixels(body.group.position);
    if (!center) return;
    const radius = world.pixelRadius(body);
    const color = body.colored ? colorOf(body.index) : themeColor("--muted");
    if (body.moves && radius < SMALL_BODY) {
      pen.strokeStyle = color;
      pen.lineWidth = 1.5;
      pen.beginPath();
      pen.arc(center.x, center.y, SMALL_BODY + 2, 0, 2 * Math.PI);
      pen.stroke();
    }
    if (!this.labels) return;
    if (body.shape === "plane") return this.nameFloor(body, color);
    const up = Math.min(Math.max(radius, SMALL_BODY + 2), 0.42 * world.height);
    this.write(body.name, center.x, center.y - up - 8, color, "center");
  }

  /** On the plane, near the corner of it that is furthest from the middle of the picture. */
  nameFloor(body, color) {
    const { pen, world } = this;
    pen.font = FONT;
    const half = 0.5 * pen.measureText(body.name).width + 12;
    let best = null;
    for (const [x, z] of NAMED) {
      const seen = world.toPixels(body.group.localToWorld(new THREE.Vector3(x, 0, z)));
      if (!seen || seen.x < half || seen.x > world.width - half || seen.y < 60 || seen.y > world.height - 20) continue;
      const away = Math.abs(seen.x - 0.5 * world.width) + Math.abs(seen.y - 0.5 * world.height);
      if (!best || away > best.away) best = { ...seen, away };
    }
    if (best) this.write(body.name, best.x, best.y, color, "center");
  }

  /** Text that is readable on anything, inside the picture. */
  write(text, x, y, color, align) {
    const { pen, world } = this;
    pen.font = FONT;
    pen.textBaseline = "middle";
    pen.textAlign = align;
    const half = align === "center" ? 0.5 * pen.measureText(text).width : 0;
    const place = Math.min(world.width - half - 4, Math.max(half + 4, x));
    const height = Math.min(world.height - 10, Math.max(10, y));
    pen.lineWidth = 3.5;
    pen.lineJoin = "round";
    pen.strokeStyle = themeColor("--stage");
    pen.strokeText(text, place, height);
    pen.fillStyle = color;
    pen.fillText(text, place, height);
  }

  /** Beyond the tip of one arrow of each contact: both forces are of one size. */
  drawForces() {
    for (const contact of this.world.contacts) {
      const force = contact.forces.find((one) => one.arrow.arrow.visible && one.body.moves) ?? contact.forces.find((one) => one.arrow.arrow.visible);
      const [root, tip] = force ? [this.world.toPixels(force.root), this.world.toPixels(force.tip)] : [null, null];
      if (!root || !tip) continue;
      const length = Math.hypot(tip.x - root.x, tip.y - root.y) || 1;
      const [x, y] = [(tip.x - root.x) / length, (tip.y - root.y) / length];
      this.write(`${shortNumber(force.value)} N`, tip.x + 16 * x, tip.y + 16 * y, themeColor("--force"), x < 0 ? "right" : "left");
    }
  }

  drawAxes() {
    const { pen, world } = this;
    const turned = world.camera.quaternion.clone().invert();
    const [x, y, size] = [38, world.height - 38, 24];
    const ends = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => new THREE.Vector3(...axis).applyQuaternion(turned));
    ends.forEach((end, k) => {
      pen.strokeStyle = themeColor("--text");
      pen.lineWidth = 1.6;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + size * end.x, y - size * end.y);
      pen.stroke();
      if (Math.hypot(end.x, end.y) > 0.15) this.write("xyz"[k], x + 1.35 * size * end.x, y - 1.35 * size * end.y, themeColor("--text"), "center");
    });
  }
}
