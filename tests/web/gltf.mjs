// What three.js and three-vrm make of a GLB, VRM or VRMA; called by tests/reading_gltf.py.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { VRMLoaderPlugin } from "@pixiv/three-vrm";
import { VRMAnimationLoaderPlugin } from "@pixiv/three-vrm-animation";

let gltf, mixer;

function meshes() {
  const found = [];
  gltf.scene.traverse((object) => {
    if (object.isMesh) found.push(object);
  });
  return found;
}

const plain = (track) => ({
  name: track.name,
  times: Array.from(track.times),
  values: Array.from(track.values),
  interpolation: track.createInterpolant?.isInterpolantFactoryMethodGLTFCubicSpline
    ? "CUBICSPLINE" : "LINEAR",
});

window.reader = {
  async load(url) {
    const loader = new GLTFLoader();
    loader.register((parser) => new VRMLoaderPlugin(parser));
    loader.register((parser) => new VRMAnimationLoaderPlugin(parser));
    gltf = await loader.loadAsync(url);
    gltf.scene.updateMatrixWorld(true);
    mixer = new THREE.AnimationMixer(gltf.scene);
    return {
      meshes: meshes().map((mesh) => ({
        name: mesh.name,
        targets: mesh.morphTargetDictionary ?? {},
        vertices: mesh.geometry.attributes.position.count,
      })),
      animations: gltf.animations.map((clip) => ({
        name: clip.name, duration: clip.duration, tracks: clip.tracks.map(plain),
      })),
      extras: gltf.asset.extras ?? null,
      vrm: gltf.userData.vrm ? gltf.userData.vrm.meta.metaVersion : null,
    };
  },

  // The weights of each mesh and the turn of each node that has a name, at each time.
  sample(times, which = gltf.animations.length - 1) {
    mixer.stopAllAction();
    const action = mixer.clipAction(gltf.animations[which]);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
    return times.map((time) => {
      action.reset();
      mixer.setTime(time);
      return this.state();
    });
  },

  state() {
    const turns = {}, places = {};
    gltf.scene.updateMatrixWorld(true);
    gltf.scene.traverse((object) => {
      turns[object.name] = object.getWorldQuaternion(new THREE.Quaternion()).toArray();
      places[object.name] = object.getWorldPosition(new THREE.Vector3()).toArray();
    });
    const weights = meshes().map((mesh) => Array.from(mesh.morphTargetInfluences ?? []));
    return { weights, turns, places };
  },

  // The vertices of each mesh in the scene at a time, as three.js moves them.
  shown(time) {
    this.sample([time]);
    gltf.scene.updateMatrixWorld(true);
    return meshes().map((mesh) => {
      const place = new THREE.Vector3();
      const found = [];
      for (let i = 0; i < mesh.geometry.attributes.position.count; i++)
        found.push(...mesh.getVertexPosition(i, place).applyMatrix4(mesh.matrixWorld).toArray());
      return found;
    });
  },

  // The vertices of each mesh under weights, as three.js moves them.
  pose(weights) {
    mixer.stopAllAction();
    gltf.scene.updateMatrixWorld(true);
    return meshes().map((mesh) => {
      weights.forEach((weight, place) => (mesh.morphTargetInfluences[place] = weight));
      const place = new THREE.Vector3();
      const found = [];
      for (let i = 0; i < mesh.geometry.attributes.position.count; i++)
        found.push(...mesh.getVertexPosition(i, place).toArray());
      return found;
    });
  },

  // The weights of each mesh as three-vrm sets them for expressions.
  express(values) {
    const manager = gltf.userData.vrm.expressionManager;
    manager.resetValues();
    for (const [name, value] of Object.entries(values)) manager.setValue(name, value);
    manager.update();
    return meshes().map((mesh) => Array.from(mesh.morphTargetInfluences ?? []));
  },

  vrma() {
    return gltf.userData.vrmAnimations.map((animation) => ({
      duration: animation.duration,
      preset: Object.fromEntries([...animation.expressionTracks.preset].map(([k, v]) => [k, plain(v)])),
      custom: Object.fromEntries([...animation.expressionTracks.custom].map(([k, v]) => [k, plain(v)])),
      rotation: Object.fromEntries([...animation.humanoidTracks.rotation].map(([k, v]) => [k, plain(v)])),
    }));
  },

  draw(time, position = [0, 0.08, 0.75], target = [0, 0.06, 0]) {
    this.sample([time]);
    const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    renderer.setSize(480, 480);
    document.body.replaceChildren(renderer.domElement);
    const scene = new THREE.Scene();
    scene.background = new THREE.Color(0x888888);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x444444, 2));
    const light = new THREE.DirectionalLight(0xffffff, 2);
    light.position.set(0.5, 1, 1);
    scene.add(light, gltf.scene);
    const camera = new THREE.PerspectiveCamera(30, 1, 0.01, 10);
    camera.position.set(...position);
    camera.lookAt(...target);
    renderer.render(scene, camera);
  },
};
document.body.dataset.ready = "";
