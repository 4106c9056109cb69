// Colours of the scene's directions: distinct first, then as far apart as the golden ratio takes them.

const kFirst = ['#4f9dff', '#ff8f3f', '#3ddc97', '#e667d3', '#ffd84d', '#9d7bff', '#4fd8e0', '#ff6f7d'];
const kNoGroup = '#8b97a6';
const cache = new Map();

/** CSS colour of a direction's number; -1: of no group. */
export function cssColour(number) {
  if (number < 0) return kNoGroup;
  if (number < kFirst.length) return kFirst[number];
  return `hsl(${Math.round((number * 0.618034 * 360) % 360)}, 70%, 62%)`;
}

export function colour(number) {
  if (!cache.has(number)) cache.set(number, new THREE.Color(cssColour(number)));
  return cache.get(number);
}

export const kLayerColours = {
  trajectory: '#6ea8fe', truth: '#ffd84d', keyframes: '#c3d0e0', covisibility: '#ff5d5d', egraph: '#3ddc97', grid: '#3a4656',
};
