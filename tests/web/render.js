// In the browser: draws glTF models with three.js, seen from where the whole of the first one is in view.
import * as THREE from "three";
import {GLTFLoader} from "three/addons/loaders/GLTFLoader.js";
import {DRACOLoader} from "three/addons/loaders/DRACOLoader.js";
import {KTX2Loader} from "three/addons/loaders/KTX2Loader.js";
import {MeshoptDecoder} from "three/addons/libs/meshopt_decoder.module.js";

const size = 512;
const renderer = new THREE.WebGLRenderer({antialias: false, alpha: true, preserveDrawingBuffer: true});
renderer.setSize(size, size, false);
renderer.setClearColor(0x000000, 0);

const loader = new GLTFLoader();
loader.setDRACOLoader(new DRACOLoader().setDecoderPath("/three/examples/jsm/libs/draco/gltf/"));
loader.setKTX2Loader(new KTX2Loader().setTranscoderPath("/three/examples/jsm/libs/basis/").detectSupport(renderer));
loader.setMeshoptDecoder(MeshoptDecoder);

// Light from everywhere, and a little more from above the camera: shapes show, and no side is black.
function lights(camera) {
  const lamp = new THREE.DirectionalLight(0xffffff, 1.5);
  lamp.position.copy(camera.position).y += camera.position.length() / 2;
  return [new THREE.HemisphereLight(0xffffff, 0x888888, 2), lamp];
}

// The box around a model as it is shown, with skins and morph targets in their poses.
function boxOf(root) {
  root.updateMatrixWorld(true);
  return new THREE.Box3().setFromObject(root, true);
}

function cameraFor(box) {
  const centre = box.getCenter(new THREE.Vector3()), radius = box.getSize(new THREE.Vector3()).length() / 2 || 1;
  const camera = new THREE.PerspectiveCamera(30, 1, radius / 20, radius * 20);
  camera.position.copy(centre).addScaledVector(new THREE.Vector3(0.5, 0.4, 1).normalize(), radius / Math.sin(Math.PI / 12));
  camera.lookAt(centre);
  return camera;
}

// As engines do: texels that are longer than wide are otherwise blurred to their length.
function filterByDirection(root) {
  root.traverse((node) => [node.material].flat().forEach((material) => Object.values(material ?? {}).forEach((value) => {
    if (value?.isTexture) value.anisotropy = renderer.capabilities.getMaxAnisotropy();
  })));
}

// RGBA rows from the top down.
function draw(root, camera) {
  filterByDirection(root);
  const scene = new THREE.Scene();
  scene.add(root, ...lights(camera));
  renderer.render(scene, camera);
  const gl = renderer.getContext(), pixels = new Uint8Array(4 * size * size), out = new Uint8ClampedArray(pixels.length);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  for (let y = 0; y < size; ++y) out.set(pixels.subarray(4 * size * y, 4 * size * (y + 1)), 4 * size * (size - 1 - y));
  return new ImageData(out, size, size);
}

const colourDifference = (a, b, i) => (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2])) / 3;

// How much of the two silhouettes is common (1: all of it), and how far colours are apart within (0 to 255, mean).
function compare(a, b) {
  let either = 0, both = 0, difference = 0;
  for (let i = 0; i < a.length; i += 4) {
    const inA = a[i + 3] > 127, inB = b[i + 3] > 127;
    if (inA || inB) ++either;
    if (!inA || !inB) continue;
    ++both;
    difference += colourDifference(a, b, i);
  }
  return {covered: either, overlap: either ? both / either : 0, difference: both ? difference / both : 0};
}

// Input, output and, four times as strong, their difference.
function sideBySide(images) {
  const canvas = document.createElement("canvas");
  canvas.width = 3 * size;
  canvas.height = size;
  const context = canvas.getContext("2d");
  context.fillStyle = "#dde3e8";
  context.fillRect(0, 0, canvas.width, canvas.height);
  const [a, b] = images.map((image) => image.data), difference = new ImageData(size, size);
  for (let i = 0; i < a.length; i += 4) {
    difference.data.fill(a[i + 3] > 127 || b[i + 3] > 127 ? Math.min(255, 4 * colourDifference(a, b, i)) : 0, i, i + 3);
    difference.data[i + 3] = 255;
  }
  [...images, difference].forEach((image, i) => {
    const part = new OffscreenCanvas(size, size);
    part.getContext("2d").putImageData(image, 0, 0);
    context.drawImage(part, i * size, 0);
  });
  return canvas.toDataURL("image/png");
}

window.compareModels = async (input, output) => {
  const roots = [];
  for (const address of [input, output]) roots.push((await loader.loadAsync(address)).scene);
  const camera = cameraFor(boxOf(roots[0]));
  const images = roots.map((root) => draw(root, camera));
  return {...compare(images[0].data, images[1].data), picture: sideBySide(images)};
};
window.ready = true;
