// What three.js makes of skinned meshes in a GLB, and of BVH; called by tests/test_bone_export.py.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { BVHLoader } from "three/addons/loaders/BVHLoader.js";

let gltf, mixer;

const skinned = () => {
  const found = [];
  gltf.scene.traverse((object) => object.isSkinnedMesh && found.push(object));
  return found;
};

export async function load(url) {
  gltf = await new GLTFLoader().loadAsync(url);
  mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) {
    const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
  }
  return skinned().map((mesh) => mesh.skeleton.bones.map((bone) => [bone.name, bone.parent.name]));
}

// The coordinates of all vertices, one mesh after the other, at a time in s.
export function posedAt(time) {
  mixer.setTime(time);
  gltf.scene.updateMatrixWorld(true);
  const place = new THREE.Vector3();
  return skinned().flatMap((mesh) => {
    mesh.skeleton.update();
    const count = mesh.geometry.attributes.position.count;
    const found = [];
    for (let i = 0; i < count; i++)
      found.push(...mesh.getVertexPosition(i, place).applyMatrix4(mesh.matrixWorld).toArray());
    return found;
  });
}

export async function readBvh(url) {
  const { skeleton, clip } = await new BVHLoader().loadAsync(url);
  return {
    bones: skeleton.bones.map((bone) => ({
      name: bone.name, parent: bone.parent ? bone.parent.name : "", at: bone.position.toArray(),
    })),
    tracks: Object.fromEntries(clip.tracks.map((track) => [
      track.name, { times: Array.from(track.times), values: Array.from(track.values) },
    ])),
  };
}
