// The 3D view: renderer, cameras, points of view. It draws only when something has changed.

const kFieldOfView = 50;     // degrees
const kTightness = 0.66;     // a scene fills its bounding sphere by about so much
const kStillAfter = 250;     // ms without a movement
const kSphere = 170;         // pixels
const kBackground = 0x11161d;
const kNarrow = 900;         // pixels: narrower pages have their panels below
const kPanels = 104;         // pixels by which the right panels are wider than the left ones, halved

export class View {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: true});
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setClearColor(kBackground);
    this.renderer.autoClear = false;
    this.scene = new THREE.Scene();
    this.world = new THREE.Group();  // everything in the coordinates of the SLAM system
    this.world.matrixAutoUpdate = false;
    this.scene.add(this.world);
    this.camera = new THREE.PerspectiveCamera(kFieldOfView, 1, 0.05, 500);
    this.camera.position.set(3, 4, 6);
    const light = new THREE.DirectionalLight(0xffffff, 0.35);
    light.position.set(0.3, 0.6, 1);
    this.camera.add(light);
    this.scene.add(this.camera, new THREE.AmbientLight(0xffffff, 0.75));
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => this.moved());
    this.controls.addEventListener('start', () => { this.touched = true; });
    this.mode = 'orbit';
    this.touched = false;   // until the user takes over, the view follows the scene's growth
    this.bounds = new THREE.Box3();
    this.inset = null;      // {scene, camera}: drawn in the corner
    this.beforeDrawing = [];
    this.stats = {frames: 0, milliseconds: 0};
    this.lastMove = 0;
    this.dirty = true;
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    requestAnimationFrame(() => this.loop());
  }

  invalidate() {
    this.dirty = true;
  }

  moved() {
    this.lastMove = performance.now();
    this.dirty = true;
  }

  /** Puts "up" up. In a mirrored world, whose coordinates are left-handed, left and right are swapped to show it as it is. */
  orient(up, mirrored) {
    const u = new THREE.Vector3().fromArray(up).normalize();
    const ahead = new THREE.Vector3(0, 0, 1);
    ahead.addScaledVector(u, -ahead.dot(u)).normalize();
    const right = new THREE.Vector3().crossVectors(ahead, u).multiplyScalar(mirrored ? -1 : 1);
    const matrix = new THREE.Matrix4().set(
        right.x, right.y, right.z, 0, u.x, u.y, u.z, 0, -ahead.x, -ahead.y, -ahead.z, 0, 0, 0, 0, 1);
    if (matrix.equals(this.world.matrix)) return;
    this.world.matrix.copy(matrix);
    this.world.matrixWorldNeedsUpdate = true;
    this.invalidate();
  }

  /** The scene has grown to this box (world coordinates of the SLAM system). */
  setBounds(box) {
    if (box.isEmpty()) return;
    this.bounds.copy(box).applyMatrix4(this.world.matrix);
    if (!this.touched && this.mode !== 'follow') this.frame();
  }

  setMode(mode) {
    this.mode = mode;
    this.touched = false;
    this.controls.enabled = mode !== 'follow';
    if (mode !== 'follow') this.frame();
    this.moved();
  }

  /** Looks at the whole scene, from the side and above, or from straight above. */
  frame() {
    if (this.bounds.isEmpty()) return;
    const centre = this.bounds.getCenter(new THREE.Vector3());
    const radius = this.bounds.getSize(new THREE.Vector3()).length() / 2;
    const direction = this.mode === 'top' ? new THREE.Vector3(0, 1, 0.001) : new THREE.Vector3(0.55, 0.75, 0.8);
    const free = Math.min(1, this.canvas.clientWidth > kNarrow ? this.camera.aspect - 0.7 : this.camera.aspect);
    const distance = radius / Math.sin(THREE.Math.degToRad(kFieldOfView / 2)) / free * kTightness;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction.normalize(), distance);
    this.controls.update();
    this.invalidate();
  }

  /** Goes behind the camera whose pose (world from camera) is given, in follow mode. */
  follow(pose, mirrored) {
    if (this.mode !== 'follow') return;
    const worldPose = new THREE.Matrix4().multiplyMatrices(this.world.matrix, pose);
    const down = mirrored ? 1 : -1;
    const eye = new THREE.Vector3(0, down * 0.5, -1.4).applyMatrix4(worldPose);
    const target = new THREE.Vector3(0, 0, 1.5).applyMatrix4(worldPose);
    this.camera.position.lerp(eye, 0.35);
    this.controls.target.lerp(target, 0.35);
    this.camera.lookAt(this.controls.target);
    this.invalidate();
  }

  /** Pixels on the screen of a length of one metre at a distance of one metre. */
  pixelsPerRadian() {
    return this.canvas.clientHeight * this.renderer.getPixelRatio() / THREE.Math.degToRad(kFieldOfView);
  }

  isMoving() {
    return performance.now() - this.lastMove < kStillAfter;
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    // The middle of what the panels leave free.
    const shift = width > kNarrow ? kPanels : 0;
    this.camera.setViewOffset(width, height, shift, 0, width, height);
    this.invalidate();
  }

  loop() {
    requestAnimationFrame(() => this.loop());
    const moving = this.isMoving();
    if (this.wasMoving && !moving) this.dirty = true;  // once more, in full detail
    this.wasMoving = moving;
    if (!this.dirty) return;
    this.dirty = false;
    this.draw();
  }

  draw() {
    const start = performance.now();
    for (const prepare of this.beforeDrawing) prepare(this);
    const {clientWidth: width, clientHeight: height} = this.canvas;
    this.renderer.setViewport(0, 0, width, height);
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    this.triangles = this.renderer.info.render.triangles;
    if (this.inset && width > kNarrow) {
      this.inset.camera.quaternion.copy(this.camera.quaternion);
      this.inset.camera.position.set(0, 0, 3.2).applyQuaternion(this.camera.quaternion);
      this.renderer.setViewport(12, 24, kSphere, kSphere);
      this.renderer.clearDepth();
      this.renderer.render(this.inset.scene, this.inset.camera);
    }
    ++this.stats.frames;
    this.stats.milliseconds = performance.now() - start;
  }
}
