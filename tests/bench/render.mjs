// Renders two models with three.js in headless Chromium, from the same views with the same light, and compares them.
//
//   npm install --prefix tests/web   # once
//   node tests/bench/render.mjs [--unlit] BEFORE.glb AFTER.glb [PICTURE.png]
//
// --unlit: the base colour as it is, without light.
// Prints, for three views of 1024 x 1024 pixels, the PSNR of AFTER against BEFORE (sRGB bytes) over the pixels that either
// covers, and over those that both cover wholly: the shading alone, without the outline. PICTURE: both side by side in the
// first view, and their difference times eight.
import {createServer} from 'node:http';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {spawn} from 'node:child_process';
import {tmpdir} from 'node:os';
import {dirname, join, normalize} from 'node:path';
import {fileURLToPath} from 'node:url';

const is_unlit = process.argv[2] === '--unlit';
const [before, after, picture] = process.argv.slice(is_unlit ? 3 : 2);
const three = join(dirname(fileURLToPath(import.meta.url)), '..', 'web', 'node_modules', 'three');

const page = `<!doctype html><script type="importmap">{"imports": {"three": "/three/build/three.module.js"}}</script>
<script type="module">
import * as THREE from 'three';
import {GLTFLoader} from '/three/examples/jsm/loaders/GLTFLoader.js';
const size = 1024;
const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true, alpha: true});
renderer.setSize(size, size, false);
renderer.setClearColor(0, 0);
async function load(name) {
  const gltf = await new GLTFLoader().loadAsync(name);
  gltf.scene.updateMatrixWorld(true);
  gltf.scene.traverse(o => {
    if (o.isMesh && ${is_unlit})
      o.material = new THREE.MeshBasicMaterial({map: o.material.map, color: o.material.color, side: o.material.side,
                                                vertexColors: o.material.vertexColors, toneMapped: false});
    for (const m of o.isMesh ? [o.material].flat() : []) {
      for (const map of [m.map, m.normalMap, m.roughnessMap, m.emissiveMap, m.aoMap]) if (map) map.anisotropy = 8;
    }
  });
  return gltf.scene;
}
function pixels(scene, view) {
  const box = new THREE.Box3().setFromObject(scene), centre = box.getCenter(new THREE.Vector3());
  const radius = box.getSize(new THREE.Vector3()).length() / 2;
  const stage = new THREE.Scene();
  stage.add(scene, new THREE.HemisphereLight(0xddeeff, 0x444433, 1.5));
  const sun = new THREE.DirectionalLight(0xffffff, 2.5);
  sun.position.copy(centre).add(new THREE.Vector3(1, 2, 3));
  sun.target.position.copy(centre);
  stage.add(sun, sun.target);
  const camera = new THREE.PerspectiveCamera(30, 1, radius / 100, radius * 20);
  camera.position.copy(centre).add(new THREE.Vector3(...view).normalize().multiplyScalar(radius * 3.6));
  camera.lookAt(centre);
  renderer.render(stage, camera);
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  const context = canvas.getContext('2d', {willReadFrequently: true});
  context.drawImage(renderer.domElement, 0, 0);
  return context.getImageData(0, 0, size, size);
}
function psnr(a, b, inside) {
  let sum = 0, count = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const [first, second] = [a.data[i + 3], b.data[i + 3]];
    if (inside ? first !== 255 || second !== 255 : first === 0 && second === 0) continue;
    for (let c = 0; c < 3; ++c) sum += (a.data[i + c] - b.data[i + c]) ** 2;
    count += 3;
  }
  return sum === 0 ? Infinity : 10 * Math.log10(255 * 255 * count / sum);
}
function side_by_side(a, b) {
  const canvas = document.createElement('canvas');
  canvas.width = 3 * size;
  canvas.height = size;
  const context = canvas.getContext('2d');
  const difference = new ImageData(size, size);
  for (let i = 0; i < a.data.length; i += 4) {
    for (let c = 0; c < 3; ++c) difference.data[i + c] = 8 * Math.abs(a.data[i + c] - b.data[i + c]);
    difference.data[i + 3] = 255;
  }
  [a, b, difference].forEach((image, i) => context.putImageData(image, i * size, 0));
  return canvas.toDataURL('image/png');
}
let answer;
try {
  const [before, after] = [await load('/before/model'), await load('/after/model')];
  const psnrs = [];
  let picture;
  for (const view of [[0.6, 0.4, 1], [-1, 0.2, -0.4], [0.3, -0.7, -1]]) {
    const [a, b] = [pixels(before, view), pixels(after, view)];
    psnrs.push([psnr(a, b, false), psnr(a, b, true)]);
    picture ??= side_by_side(a, b);
  }
  answer = {psnrs, picture};
} catch (error) {
  answer = {error: String(error)};
}
await fetch('/answer', {method: 'POST', body: JSON.stringify(answer)});
</script>`;

const profile = mkdtempSync(join(tmpdir(), 'render-'));
const server = createServer(async (request, response) => {
  const path = normalize(decodeURIComponent(request.url));
  if (path === '/answer') {
    const chunks = [];
    for await (const chunk of request) chunks.push(chunk);
    response.end();
    finish(JSON.parse(Buffer.concat(chunks)));
    return;
  }
  try {
    if (path === '/') return response.setHeader('Content-Type', 'text/html').end(page);
    const model = {before, after}[path.split('/')[1]];
    const file = path.startsWith('/three/') ? join(three, path.slice(7))
                 : path.endsWith('/model')  ? model
                                            : join(dirname(model), path.split('/').slice(2).join('/'));
    if (file.endsWith('.js')) response.setHeader('Content-Type', 'text/javascript');
    response.end(readFileSync(file));
  } catch {
    response.writeHead(404).end();
  }
});
server.listen(0, '127.0.0.1');
const browser = await new Promise(resolve => server.once('listening', () => resolve(spawn(
    'chromium', ['--headless', '--no-sandbox', '--disable-gpu-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
                 '--enable-unsafe-swiftshader', `--user-data-dir=${profile}`, `http://127.0.0.1:${server.address().port}/`],
    {stdio: 'ignore'}))));
const timer = setTimeout(() => finish({error: 'no answer within five minutes'}), 300000);

function finish({error, psnrs, picture: url}) {
  clearTimeout(timer);
  browser.once('exit', () => rmSync(profile, {recursive: true, force: true, maxRetries: 5}));
  browser.kill();
  server.close();
  server.closeAllConnections();
  if (error) {
    console.error(error);
    process.exitCode = 1;
    return;
  }
  const shown = (psnr) => psnr === null ? 'no difference' : psnr.toFixed(2); // JSON has no infinity
  console.log(psnrs.map(([all, inside]) => `${shown(all)} (inside ${shown(inside)})`).join('  '), 'dB');
  if (picture) writeFileSync(picture, Buffer.from(url.split(',')[1], 'base64'));
}
