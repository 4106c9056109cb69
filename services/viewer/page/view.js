// The 3D view: renderer, cameras, points of view. It draws only when something has changed.

const kFieldOfView = 50;     // degrees
const kStillAfter = 250;     // ms without a movement
const kSphere = 170;         // pixels
const kFollowing = 0.35;     // of the way to where the followed camera is, per pose
const kBackground = 0x11161d;
export const kNarrow = 900;         // pixels: narrower pages have their panels below
const kLeft = 228, kRight = 436, kTop = 44;  // pixels that panels and header take
const kMargin = 24;

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
    this.behind = false;    // of the camera that is followed
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
    this.behind = false;    // of the camera that is followed
    this.controls.enabled = mode !== 'follow';
    if (mode !== 'follow') this.frame();
    this.moved();
  }

  /** Looks at the whole scene, from the side and above, or from straight above. */
  frame() {
    if (this.bounds.isEmpty()) return;
    const centre = this.bounds.getCenter(new THREE.Vector3());
    const back = this.mode === 'top' ? new THREE.Vector3(0, 1, 0.001) : new THREE.Vector3(0.55, 0.75, 0.8);
    back.normalize();
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(back, this.distanceToSeeAll(centre, back));
    this.controls.update();
    this.invalidate();
  }

  /** How far from the centre, in the direction "back", every corner of the scene is in the free part of the canvas. */
  distanceToSeeAll(centre, back) {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const {left, right, top} = this.margins();
    const perPixel = 2 * Math.tan(THREE.Math.degToRad(kFieldOfView / 2)) / height;
    const slopeX = perPixel * Math.max(1, width - left - right - 2 * kMargin) / 2;
    const slopeY = perPixel * Math.max(1, height - top - 2 * kMargin) / 2;
    const across = new THREE.Vector3(0, 1, 0).cross(back).normalize();
    const upwards = new THREE.Vector3().crossVectors(back, across);
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const {min, max} = this.bounds;
      const offset = new THREE.Vector3(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z)
          .sub(centre);
      const wide = Math.max(Math.abs(offset.dot(across)) / slopeX, Math.abs(offset.dot(upwards)) / slopeY);
      distance = Math.max(distance, offset.dot(back) + wide);
    }
    return distance;
  }

  /** Pixels of the canvas that are covered. */
  margins() {
    const wide = this.canvas.clientWidth > kNarrow;
    return {left: wide ? kLeft : 0, right: wide ? kRight : 0, top: kTop};
  }

  /** Goes behind the camera whose pose (world from camera) is given, in follow mode. */
  follow(pose, mirrored) {
    if (this.mode !== 'follow') return;
    const worldPose = new THREE.Matrix4().multiplyMatrices(this.world.matrix, pose);
    const down = mirrored ? 1 : -1;
    const eye = new THREE.Vector3(0, down * 0.5, -1.4).applyMatrix4(worldPose);
    const target = new THREE.Vector3(0, 0, 1.5).applyMatrix4(worldPose);
    const step = this.behind ? kFollowing : 1;
    this.behind = true;
    this.camera.position.lerp(eye, step);
    this.controls.target.lerp(target, step);
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
    const {left, right, top} = this.margins();
    this.camera.setViewOffset(width, height, (right - left) / 2, -top / 2, width, height);
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
