import {CameraLayer} from './camera_layer.js';
import {connect} from './connection.js';
import {EdgeLayer, KeyframeLayer, SelectionLayer} from './graph_layer.js';
import {GridLayer} from './grid_layer.js';
import {HealthPanel} from './health_panel.js';
import {ImagePanel} from './image_panel.js';
import {KeyframeCard} from './keyframe_card.js';
import {LayersPanel} from './layers_panel.js';
import {MeshLayer} from './mesh_layer.js';
import {kLayerColours} from './palette.js';
import {TrajectoryLayer, TruthLayer} from './path_layer.js';
import {SceneModel} from './scene_model.js';
import {DirectionSphere} from './sphere.js';
import {LineLayer, PlaneLayer, PointLayer} from './structure_layer.js';
import {View, kNarrow} from './view.js';

const kSilentAfter = 3;  // seconds without a new frame
const kClickRadius = 4;  // pixels: more is a drag

const view = new View(document.getElementById('view'));
const model = new SceneModel();
const mesh = new MeshLayer(view);
const trajectory = new TrajectoryLayer(view, model);
const truth = new TruthLayer(view);
const keyframes = new KeyframeLayer(view, model);
const covisibility = new EdgeLayer(view, model, 'covisibility', kLayerColours.covisibility);
const edges = new EdgeLayer(view, model, 'edges', kLayerColours.egraph);
const selection = new SelectionLayer(view, model);
const points = new PointLayer(view, model);
const lines = new LineLayer(view, model);
const planes = new PlaneLayer(view);
const camera = new CameraLayer(view);
const grid = new GridLayer(view);
const sphere = new DirectionSphere(view);
const health = new HealthPanel();
const image = new ImagePanel((bitmap) => camera.setImage(bitmap));
const card = new KeyframeCard(model, () => select(null));
const panel = new LayersPanel([
  {name: 'mesh', label: 'Mesh', colour: '#b9a58c', layer: mesh, visible: true},
  {name: 'trajectory', label: 'Trajectory', colour: kLayerColours.trajectory, layer: trajectory, visible: true},
  {name: 'truth', label: 'Ground truth', colour: kLayerColours.truth, layer: truth, visible: true},
  {name: 'keyframes', label: 'Keyframes', colour: kLayerColours.keyframes, layer: keyframes, visible: true},
  {name: 'edges', label: 'E-Graph', colour: kLayerColours.egraph, layer: edges, visible: true},
  {name: 'covisibility', label: 'Covisibility', colour: kLayerColours.covisibility, layer: covisibility, visible: false},
  {name: 'points', label: 'Points', colour: '#d5dfeb', layer: points, visible: false},
  {name: 'lines', label: 'Lines', colour: '#ff8f3f', layer: lines, visible: true},
  {name: 'planes', label: 'Planes', colour: '#9d7bff', layer: planes, visible: false},
  {name: 'grid', label: 'Grid', colour: kLayerColours.grid, layer: grid, visible: true},
], () => view.invalidate());

const errors = [];           // what should not have happened
window.addEventListener('error', (event) => errors.push(event.message));
window.addEventListener('unhandledrejection', (event) => errors.push(String(event.reason)));

let latest = null;           // the newest packet "camera"
let silence = 0;             // seconds for which the viewer has heard of no frame
const stale = new Set();     // what has to be drawn anew before the next frame

const takers = {
  scene: restart,
  tile: (packet) => { mesh.take(packet); stale.add('mesh'); },
  poses: (packet) => { model.takePoses(packet); stale.add('poses'); },
  graph: (packet) => { model.takeGraph(packet); stale.add('graph'); },
  landmarks: (packet) => { model.takeLandmarks(packet); sphere.update(model.landmarks); stale.add('graph'); },
  trajectory: (packet) => { trajectory.take(packet); stale.add('trajectory'); },
  contents: (packet) => { points.take(packet); lines.take(packet); stale.add('contents'); },
  planes: (packet) => { planes.take(packet); stale.add('planes'); },
  truth: (packet) => { truth.take(packet); stale.add('truth'); },
  camera: (packet) => { latest = packet; stale.add('camera'); },
  live: (packet) => image.take(packet),
  health: (packet) => { health.take(packet); silence = packet.silence; showState(); },
};

function take(packet) {
  if (takers[packet.type]) takers[packet.type](packet);
  if (packet.type !== 'health') view.invalidate();  // every second, and not in the scene
}

/** The viewer has begun a new scene, or the connection to it. */
function restart() {
  model.clear();
  for (const layer of [mesh, trajectory, truth, points, lines, planes, camera, image]) layer.clear();
  for (const name of ['poses', 'graph', 'trajectory']) stale.add(name);
  sphere.update(model.landmarks);
  latest = null;
}

function refresh() {
  if (stale.size === 0) return;
  if (stale.has('camera') && latest) showCamera(latest);
  const moved = stale.has('poses');
  if (moved || stale.has('trajectory')) trajectory.update();
  if (moved) [keyframes, points, lines].forEach((layer) => layer.update());
  if (moved || stale.has('graph')) [edges, covisibility, selection].forEach((layer) => layer.update());
  stale.clear();
  const box = new THREE.Box3();
  mesh.bounds(box);
  trajectory.bounds(box);
  view.setBounds(box);
  grid.update(view.bounds);
  panel.update();
}

/** What the tracker said last, or for how long it has said nothing. */
function showState() {
  if (!latest) return;
  const state = latest.state.replace('_', ' ');
  const silent = silence > kSilentAfter;
  const pill = document.getElementById('state');
  pill.textContent = silent ? `no frame for ${Math.floor(silence)} s` : state;
  pill.dataset.state = silent ? 'silent' : latest.state;
  document.getElementById('reason').textContent = silent ? `the last one: ${state}` : latest.reason;
}

function showCamera(packet) {
  const {pose, up, mirrored, has_pose: hasPose} = packet;
  showState();
  document.getElementById('numbers').textContent = `matched ${packet.points} points · ${packet.lines} lines · ` +
      `${packet.planes} planes · ${packet.directions} directions`;
  view.orient(up, mirrored);
  if (!hasPose) return;
  const [a, b, c, d, e, f, g, h, k, x, y, z] = pose;
  const matrix = new THREE.Matrix4().set(a, b, c, x, d, e, f, y, g, h, k, z, 0, 0, 0, 1);
  camera.setPose(matrix, mirrored);
  view.follow(matrix, mirrored);
}

function select(keyframe) {
  selection.select(keyframe);
  card.show(keyframe);
}

let pressed = null;
view.canvas.addEventListener('pointerdown', (event) => { pressed = [event.clientX, event.clientY]; });
view.canvas.addEventListener('pointerup', (event) => {
  if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > kClickRadius) return;
  select(keyframes.pick(event.clientX, event.clientY));
});
for (const button of document.querySelectorAll('#modes button')) {
  button.onclick = () => {
    document.querySelectorAll('#modes button').forEach((other) => other.classList.toggle('chosen', other === button));
    view.setMode(button.dataset.mode);
    if (latest) showCamera(latest);
  };
}

view.beforeDrawing.unshift(refresh);
// Small screens are for the scene: panels open when they are asked for.
if (window.innerWidth <= kNarrow) {
  document.querySelectorAll('#panels details').forEach((panel) => { panel.open = panel.id === 'keyframe'; });
}
connect(take, (online) => { document.getElementById('offline').hidden = online; });

/** For tests and the curious: what is on the page, in numbers. */
window.egraph = {
  view, select,
  errors,
  pixelOfKeyframe: (id) => keyframes.pixel(id),
  summary: () => ({
    sequence: latest ? latest.sequence : -1, state: latest ? latest.state : '', image: image.shown,
    triangles: mesh.triangles, tiles: mesh.tiles.size, poses: trajectory.count, truth: truth.count,
    keyframes: keyframes.count, edges: model.countEdges('edges'), covisibility: model.countEdges('covisibility'),
    points: points.count, lines: lines.count, planes: planes.count, landmarks: model.landmarks.size,
    services: health.services.map((service) => service.service),
    silent: health.services.filter((service) => service.silent).map((service) => service.service),
    online: document.getElementById('offline').hidden, settled: !view.isMoving() && mesh.waiting.length === 0,
    drawn: view.stats.frames, drawnTriangles: view.triangles,
  }),
};
