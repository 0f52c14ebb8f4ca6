// The bodies in three dimensions. Everything is placed relative to `origin` and measured in `scale`, both doubles of
// this script: the graphics card has seven digits only, too few for a ball of 1 mm in a tube of 10 m.

const SEGMENTS = 64; // of a circle
const HIGH = new THREE.Vector3(0, 0, 1);
const NORMAL = new THREE.Vector3(0, 1, 0); // the axis of three.js's cylinders
const FLOOR = 2; // half the side of the square that is drawn of a plane, in radii of the first view
const FLOOR_LINES = 10; // on it, on either side of its middle
const BEYOND = [1.6, 0.6]; // how far an infinite cylinder is drawn beyond what meets it: of its radius, of the first view's
const FADED = 0.6; // part of that in which it fades away: it has no end
const RINGS = 24; // of its triangles, so that fading is even
const SHADOWED = 2.2; // half the side of the square in which shadows fall, in radii of the view
const SHADOW_POINTS = 1024; // of the picture of shadows in each direction
const STRIPES = 8; // of a body that turns, light and dark, between meridians
const DARKER = 0.55; // the dark ones
const ARROW = 0.2; // length of the longest force arrow as a part of the camera's distance

/** Whether there is no graphics card: then smooth edges cost more than they are worth. */
function drawnByProcessor() {
  const probe = document.createElement("canvas").getContext("webgl2");
  const about = probe && probe.getExtension("WEBGL_debug_renderer_info");
  const name = about ? probe.getParameter(about.UNMASKED_RENDERER_WEBGL) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** How much is seen of an infinite cylinder at this part of its half length, the last `fade` of which fades away. */
function fading(part, fade) {
  return Math.min(1, (1 - Math.abs(part)) / fade);
}

class World {
  constructor(canvas, data, playback) {
    this.data = data;
    this.playback = playback;
    this.times = decodeNumbers(data.time);
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !drawnByProcessor() });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.1, 100);
    this.camera.up.copy(HIGH);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.bodies = data.bodies.map((body, index) => this.makeBody(body, index));
    this.contacts = data.contacts.map((contact) => this.makeContact(contact));
    this.largestForce = Math.max(0, ...this.contacts.map((contact) => contact.largest));
    this.lights();
    this.show = { trails: true, forces: true };
    this.rootArrows = true;
    this.follow(null);
    this.restyle();
  }

  lights() {
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x6a7282, 1.9));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.3);
    lamp.position.set(-2, -3, 4);
    this.camera.add(lamp);
    this.scene.add(this.camera);
    // From straight above: the shadow of a body lies below it, which tells how high it is.
    const sun = new THREE.DirectionalLight(0xffffff, 1.3);
    sun.position.set(0, 0, 4 * SHADOWED);
    sun.castShadow = true;
    sun.shadow.mapSize.set(SHADOW_POINTS, SHADOW_POINTS);
    Object.assign(sun.shadow.camera, { left: -SHADOWED, right: SHADOWED, top: SHADOWED, bottom: -SHADOWED, near: SHADOWED, far: 7 * SHADOWED });
    sun.shadow.normalBias = 0.01;
    this.renderer.shadowMap.enabled = true;
    this.scene.add(sun, sun.target);
  }

  makeBody(body, index) {
    const group = new THREE.Group();
    const path = new Path(this.times, body.position, body.velocity);
    const turning = body.orientation ? new Turning(body.orientation) : null;
    const axis = body.axis ? new THREE.Vector3(...body.axis) : null;
    const made = { ...body, group, path, turning, index, at: [0, 0, 0], materials: [] };
    // The frame of a body that turns has its axis along z: its orientation brings that to where the axis is.
    made.upright = axis ? new THREE.Quaternion().setFromUnitVectors(NORMAL, turning ? HIGH : axis) : new THREE.Quaternion();
    const flat = body.shape === "plane";
    made.half = flat ? 0 : axis && !body.ring ? this.halfLength(body) : body.radius;
    if (flat) made.extent = FLOOR * this.data.view.radius;
    if (body.ring) made.extent = body.ring + body.radius;
    made.mesh = flat ? this.makeFloor(made) : body.ring ? this.makeRing(made) : this.makeSolid(made, axis);
    // Parts of the half length in which an infinite cylinder fades away
    made.fade = body.reach === null ? 0 : FADED * (1 - body.reach / made.half);
    if (turning || made.fade) this.shade(made.mesh, Boolean(turning), made.fade);
    made.mesh.castShadow = !body.hollow && !flat;
    made.mesh.receiveShadow = true;
    group.add(made.mesh);
    if (body.hollow || axis || turning) group.add(this.makeNet(made, axis));
    made.trail = body.moves ? this.makeTrail(made) : null;
    this.scene.add(group);
    if (made.trail) this.scene.add(made.trail);
    return made;
  }

  /** Half the length that is drawn: of an infinite cylinder, somewhat further than the bodies go. */
  halfLength(body) {
    if (body.length !== null) return 0.5 * body.length;
    return body.reach + Math.max(BEYOND[0] * body.radius, BEYOND[1] * this.data.view.radius);
  }

  makeSolid(body, axis) {
    const material = new THREE.MeshLambertMaterial({});
    if (body.hollow) Object.assign(material, { transparent: true, opacity: 0.3, side: THREE.BackSide, depthWrite: false });
    const open = body.hollow || body.length === null;
    const rings = body.reach === null ? 1 : RINGS;
    const shape = axis ? new THREE.CylinderGeometry(1, 1, 2, SEGMENTS, rings, open) : this.ballsOf(body);
    const mesh = new THREE.Mesh(shape, material);
    mesh.renderOrder = body.hollow ? 2 : 0;
    body.materials.push(material);
    return mesh;
  }

  /** A ball of radius 1, or those of a compound, around which a ball of radius 1 reaches. */
  ballsOf(body) {
    const ball = () => new THREE.SphereGeometry(1, SEGMENTS, SEGMENTS / 2);
    if (!body.parts.length) return ball();
    const balls = body.parts.map((part) => {
      const size = part.radius / body.radius;
      return ball().scale(size, size, size).translate(...part.center.map((x) => x / body.radius)).toNonIndexed();
    });
    const shape = new THREE.BufferGeometry();
    for (const name of ["position", "normal"]) {
      const values = balls.flatMap((one) => [...one.getAttribute(name).array]);
      shape.setAttribute(name, new THREE.BufferAttribute(new Float32Array(values), 3));
    }
    return shape;
  }

  /** Stripes between meridians of the shape's own axis, y; on a sphere the other way round on its other half, so that
   * turning is seen from everywhere. What has no end fades away instead. */
  shade(mesh, striped, fade) {
    const shape = mesh.geometry.index ? mesh.geometry.toNonIndexed() : mesh.geometry;
    const place = shape.getAttribute("position");
    const colors = new Float32Array(4 * place.count).fill(1);
    const ball = mesh.geometry.type === "SphereGeometry";
    for (let k = 0; k < place.count; k++) {
      const first = k - (k % 3);
      const middle = [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, corner) => sum + place.getComponent(first + corner, axis) / 3, 0));
      const stripe = Math.floor((0.5 + Math.atan2(middle[2], middle[0]) / (2 * Math.PI)) * STRIPES);
      if (striped && (stripe + (ball && middle[1] < 0 ? 1 : 0)) % 2) colors.fill(DARKER, 4 * k, 4 * k + 3);
      if (fade) colors[4 * k + 3] = fading(place.getY(k), fade);
    }
    shape.setAttribute("color", new THREE.BufferAttribute(colors, 4));
    mesh.geometry = shape;
    mesh.material.vertexColors = true;
    if (fade) mesh.material.transparent = true;
  }

  /** A square of the surface of a plane, with its normal along y; it is seen from above only. */
  makeFloor(body) {
    const material = new THREE.MeshLambertMaterial({});
    // Triangles round its middle, so that those of a plane that turns can be light and dark
    const square = [[-1, -1], [-1, 0], [-1, 1], [0, 1], [1, 1], [1, 0], [1, -1], [0, -1], [-1, -1]];
    const corners = square.slice(1).flatMap(([x, z], k) => [0, 0, 0, square[k][0], 0, square[k][1], x, 0, z]);
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(corners), 3));
    shape.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(corners.map((_, k) => (k % 3 === 1 ? 1 : 0))), 3));
    body.materials.push(material);
    return new THREE.Mesh(shape, material);
  }

  /** The place on a torus of outer radius 1 round y: `round` goes round the ring, `about` about the tube, `out` times
   * its radius. */
  onRing(body, round, about, out = 1) {
    const [ring, tube] = [body.ring / body.extent, (out * body.radius) / body.extent];
    const rho = ring + tube * Math.cos(about);
    return [rho * Math.cos(round), tube * Math.sin(about), rho * Math.sin(round)];
  }

  makeRing(body) {
    const material = new THREE.MeshLambertMaterial({});
    if (body.hollow) Object.assign(material, { transparent: true, opacity: 0.3, side: THREE.BackSide, depthWrite: false });
    const [points, normals, indices, full] = [[], [], [], 2 * Math.PI];
    for (let i = 0; i <= SEGMENTS; i++) {
      for (let k = 0; k <= SEGMENTS; k++) {
        const [round, about] = [(full * i) / SEGMENTS, (full * k) / SEGMENTS];
        points.push(...this.onRing(body, round, about));
        normals.push(Math.cos(about) * Math.cos(round), Math.sin(about), Math.cos(about) * Math.sin(round));
        const at = i * (SEGMENTS + 1) + k;
        if (i < SEGMENTS && k < SEGMENTS) indices.push(at, at + 1, at + SEGMENTS + 1, at + 1, at + SEGMENTS + 2, at + SEGMENTS + 1);
      }
    }
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    shape.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normals), 3));
    shape.setIndex(indices);
    const mesh = new THREE.Mesh(shape, material);
    mesh.renderOrder = body.hollow ? 2 : 0;
    body.materials.push(material);
    return mesh;
  }

  /** Lines of a floor, a little above it. */
  floorLines() {
    const points = [];
    for (let k = -FLOOR_LINES; k <= FLOOR_LINES; k++) {
      const place = k / FLOOR_LINES;
      points.push(place, 0.0005, -1, place, 0.0005, 1, -1, 0.0005, place, 1, 0.0005, place);
    }
    return points;
  }

  /** Circles on the surface, which make its form and its turning visible. */
  makeNet(body, axis) {
    const points = [];
    const circle = (place) => {
      for (let k = 0; k < SEGMENTS; k++) {
        points.push(...place((2 * Math.PI * k) / SEGMENTS), ...place((2 * Math.PI * (k + 1)) / SEGMENTS));
      }
    };
    const out = body.hollow ? 1 : 1.002; // in front of the surface it lies on
    if (body.shape === "plane") {
      points.push(...this.floorLines());
    } else if (body.ring) {
      for (let k = 0; k < 4; k++) circle((a) => this.onRing(body, a, (k * Math.PI) / 2, out));
      for (let k = 0; k < 8; k++) circle((a) => this.onRing(body, (k * Math.PI) / 4, a, out));
    } else if (axis) {
      const [rings, along] = body.fade ? [[0], [-1, body.fade - 1, 1 - body.fade, 1]] : [[-1, 0, 1], [-1, 1]];
      for (const y of rings) circle((a) => [out * Math.cos(a), y, out * Math.sin(a)]);
      for (let k = 0; k < 8; k++) {
        const [x, z] = [out * Math.cos((k * Math.PI) / 4), out * Math.sin((k * Math.PI) / 4)];
        for (let part = 1; part < along.length; part++) points.push(x, along[part - 1], z, x, along[part], z);
      }
    } else if (!body.parts.length) {
      circle((a) => [out * Math.cos(a), out * Math.sin(a), 0]);
      for (let k = 0; k < 3; k++) {
        const turn = (k * Math.PI) / 3;
        circle((a) => [out * Math.cos(turn) * Math.cos(a), out * Math.sin(turn) * Math.cos(a), out * Math.sin(a)]);
      }
    }
    const shape = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    const material = new THREE.LineBasicMaterial({ transparent: true, opacity: body.hollow ? 0.35 : 0.28, depthWrite: false });
    if (body.fade) {
      const colors = points.flatMap((_, k) => (k % 3 === 1 ? [1, 1, 1, fading(points[k], body.fade)] : []));
      shape.setAttribute("color", new THREE.BufferAttribute(new Float32Array(colors), 4));
      material.vertexColors = true;
    }
    body.materials.push(material);
    body.net = new THREE.LineSegments(shape, material);
    return body.net;
  }

  makeTrail(body) {
    const { center, radius } = this.data.view;
    const points = body.path.positions;
    const relative = Float32Array.from(points, (one, index) => (one - center[index % 3]) / radius);
    const shape = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(relative, 3));
    const material = new THREE.LineBasicMaterial({ transparent: true, opacity: 1 });
    body.materials.push(material);
    const trail = new THREE.Line(shape, material);
    trail.frustumCulled = false;
    return trail;
  }

  makeContact(contact) {
    const source = this.bodies.find((body) => body.name === contact.source);
    const destination = this.bodies.find((body) => body.name === contact.destination);
    const forces = [];
    for (const [body, values] of [[source, contact.sourceForce], [destination, contact.destinationForce]]) {
      if (values) forces.push({ body, path: new Path(this.times, values, null), arrow: this.makeArrow(), value: 0, root: null, tip: null });
    }
    const point = contact.point ? new Path(this.times, contact.point, null) : null;
    const sizes = forces.length ? forces[0].path.positions : [];
    let largest = 0;
    for (let k = 0; k < sizes.length; k += 3) largest = Math.max(largest, Math.hypot(sizes[k], sizes[k + 1], sizes[k + 2]));
    return { ...contact, point, forces, largest };
  }

  /** Of length 1 along y; in front of everything, since a force acts inside the overlap. */
  makeArrow() {
    const material = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 14), material);
    const head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 18), material);
    const arrow = new THREE.Group();
    arrow.add(shaft, head);
    for (const part of [shaft, head]) part.renderOrder = 5;
    arrow.visible = false;
    this.scene.add(arrow);
    return { arrow, shaft, head, material };
  }

  // what is looked at

  /** The whole, or one body, which then stays in the middle. */
  follow(name) {
    this.followed = this.bodies.find((body) => body.name === name) ?? null;
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    this.scale = this.followed ? 4 * (this.followed.radius ?? this.data.view.radius / 4) : this.data.view.radius;
    this.look(direction.lengthSq() > 0.5 ? direction : this.firstDirection());
  }

  firstDirection() {
    const [x, y] = this.data.view.horizontal;
    return new THREE.Vector3(-x - 0.45 * y, -y + 0.45 * x, 0.42).normalize();
  }

  /** From this direction, so far away that a ball of radius `scale` fits. */
  look(direction) {
    const narrow = Math.min(1, this.camera.aspect);
    const angle = Math.atan(Math.tan((0.5 * this.camera.fov * Math.PI) / 180) * narrow);
    this.controls.target.set(0, 0, 0);
    this.camera.position.copy(direction).multiplyScalar(1.1 / Math.sin(angle));
    this.controls.update();
  }

  resize(width, height, ratio) {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    [this.width, this.height] = [width, height];
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Colours of the theme. */
  restyle() {
    this.background = new THREE.Color(themeColor("--stage"));
    this.scene.background = this.background;
    for (const body of this.bodies) {
      const color = new THREE.Color(body.colored ? colorOf(body.index) : themeColor("--still"));
      for (const material of body.materials) material.color.copy(color);
      if (body.net && !body.hollow) body.net.material.color.set(themeColor("--net"));
    }
    for (const contact of this.contacts) {
      for (const force of contact.forces) force.arrow.material.color.set(themeColor("--force"));
    }
  }

  // one frame

  /** World coordinates in m to those of the scene. */
  place(at) {
    return new THREE.Vector3((at[0] - this.origin[0]) / this.scale, (at[1] - this.origin[1]) / this.scale, (at[2] - this.origin[2]) / this.scale);
  }

  draw() {
    const t = this.playback.time;
    const row = Math.min(rowBefore(this.times, t), this.times.length - 2);
    const share = shareOf(this.times, row, t);
    for (const body of this.bodies) body.path.at(t, row, body.at);
    this.origin = this.followed ? this.followed.at : this.data.view.center;
    for (const body of this.bodies) this.placeBody(body, row, share);
    this.controls.update();
    this.setDepth();
    for (const contact of this.contacts) this.placeForces(contact, t, row);
    this.renderer.render(this.scene, this.camera);
  }

  placeBody(body, row, share) {
    body.group.position.copy(this.place(body.at));
    body.group.quaternion.copy(body.upright);
    if (body.turning) {
      const [w, x, y, z] = body.turning.at(share, row);
      body.group.quaternion.premultiply(new THREE.Quaternion(x, y, z, w));
    }
    const radius = (body.extent ?? body.radius ?? 0) / this.scale;
    body.group.scale.set(radius, body.axis && !body.extent ? body.half / this.scale : radius, radius);
    body.group.visible = radius > 0;
    if (!body.trail) return;
    body.trail.visible = this.show.trails;
    body.trail.position.copy(this.place(this.data.view.center));
    body.trail.scale.setScalar(this.data.view.radius / this.scale);
    body.trail.geometry.setDrawRange(0, row + 1);
  }

  /** Near and far planes as close as they can be: depth has 24 bits only. */
  setDepth() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    const farthest = Math.max(...this.bodies.map((body) => body.group.position.distanceTo(this.camera.position) + Math.max(body.group.scale.x, body.group.scale.y)));
    this.camera.near = 0.02 * distance;
    this.camera.far = Math.max(2 * distance, 1.1 * farthest);
    this.camera.updateProjectionMatrix();
  }

  placeForces(contact, t, row) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    for (const force of contact.forces) {
      const [x, y, z] = force.path.at(t, row);
      force.value = Math.hypot(x, y, z);
      const part = this.largestForce > 0 ? force.value / this.largestForce : 0;
      const { arrow, shaft, head } = force.arrow;
      arrow.visible = this.show.forces && part > 1e-6;
      if (!arrow.visible) continue;
      const length = ARROW * distance * (this.rootArrows ? Math.sqrt(part) : part);
      const width = Math.min(0.0042 * distance, 0.12 * length);
      const point = this.place(contact.point ? contact.point.at(t, row) : force.body.at);
      const direction = new THREE.Vector3(x, y, z).divideScalar(force.value);
      arrow.position.copy(point);
      arrow.quaternion.setFromUnitVectors(NORMAL, direction);
      const tip = Math.min(4 * width, 0.5 * length);
      shaft.scale.set(width, length - tip, width);
      shaft.position.set(0, 0.5 * (length - tip), 0);
      head.scale.set(2.4 * width, tip, 2.4 * width);
      head.position.set(0, length - 0.5 * tip, 0);
      force.root = point.clone();
      force.tip = point.addScaledVector(direction, length);
    }
  }

  /** Pixels from the top left of a point of the scene; null behind the camera. */
  toPixels(place) {
    const seen = place.clone().project(this.camera);
    if (!(Math.abs(seen.z) <= 1)) return null;
    return { x: (0.5 + 0.5 * seen.x) * this.width, y: (0.5 - 0.5 * seen.y) * this.height };
  }

  /** Radius in pixels that a body shows, near enough. */
  pixelRadius(body) {
    const distance = this.camera.position.distanceTo(body.group.position);
    return ((body.group.scale.x / distance) * 0.5 * this.height) / Math.tan((0.5 * this.camera.fov * Math.PI) / 180);
  }
}
