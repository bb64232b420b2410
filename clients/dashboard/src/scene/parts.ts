// Pieces that the machines are made of, and the two ways they are drawn: live, and as the twin's ghost.
import * as THREE from 'three';

export interface Skin {
  frame: THREE.Material;
  metal: THREE.Material;
  dark: THREE.Material;
  wheel: THREE.Material;
  accent: THREE.Material;
}

export function liveSkin(): Skin {
  const standard = (color: number, metalness: number, roughness: number) =>
    new THREE.MeshStandardMaterial({color, metalness, roughness});
  return {
    frame: standard(0x8f9bad, 0.35, 0.45),
    metal: standard(0xc3cad6, 0.7, 0.3),
    dark: standard(0x4a5568, 0.35, 0.6),
    wheel: standard(0xd69a3c, 0.65, 0.32),
    accent: standard(0x4c8dff, 0.3, 0.4),
  };
}

export function ghostSkin(): Skin {
  const ghost = new THREE.MeshBasicMaterial({color: 0x35c0b0, transparent: true, opacity: 0.1, depthWrite: false});
  return {frame: ghost, metal: ghost, dark: ghost, wheel: ghost, accent: ghost};
}

function mesh(geometry: THREE.BufferGeometry, material: THREE.Material): THREE.Mesh {
  const made = new THREE.Mesh(geometry, material);
  made.castShadow = made.receiveShadow = material instanceof THREE.MeshStandardMaterial;
  return made;
}

/** A rod between two points. */
export function rod(from: THREE.Vector3, to: THREE.Vector3, radius: number, material: THREE.Material): THREE.Mesh {
  const along = to.clone().sub(from);
  const made = mesh(new THREE.CylinderGeometry(radius, radius, along.length(), 20), material);
  made.position.copy(from).addScaledVector(along, 0.5);
  made.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
  return made;
}

/** A ring about z. */
export function ring(radius: number, thickness: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.TorusGeometry(radius, thickness, 16, 96), material);
}

/** A plate about z, centred. */
export function plate(radius: number, height: number, material: THREE.Material): THREE.Mesh {
  const made = mesh(new THREE.CylinderGeometry(radius, radius, height, 64), material);
  made.rotation.x = Math.PI / 2;
  return made;
}

export function ball(radius: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.SphereGeometry(radius, 24, 16), material);
}

export function box(x: number, y: number, z: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.BoxGeometry(x, y, z), material);
}

/** A flywheel whose axis is x: rim, spokes that show the spin, hub. */
export function flywheel(radius: number, width: number, skin: Skin): THREE.Group {
  const made = new THREE.Group();
  const rim = mesh(new THREE.TorusGeometry(radius * 0.86, radius * 0.14, 18, 64), skin.wheel);
  rim.scale.z = width / (radius * 0.28);
  rim.rotation.y = Math.PI / 2;
  const hub = mesh(new THREE.CylinderGeometry(radius * 0.2, radius * 0.2, width * 1.15, 24), skin.dark);
  hub.rotation.z = Math.PI / 2;
  made.add(rim, hub);
  for (let i = 0; i < 5; ++i) {
    const angle = i * 2 * Math.PI / 5;
    const end = new THREE.Vector3(0, radius * 0.8 * Math.cos(angle), radius * 0.8 * Math.sin(angle));
    made.add(rod(new THREE.Vector3(), end, radius * 0.06, skin.metal));
  }
  return made;
}

/** A gimbal's frame about a wheel whose axis is x; it turns about `axis`. */
export function gimbalFrame(radius: number, axis: 'y' | 'z', skin: Skin): THREE.Group {
  const made = new THREE.Group();
  const loop = ring(radius * 1.22, radius * 0.06, skin.frame);
  if (axis === 'z') loop.rotation.x = Math.PI / 2;
  made.add(loop);
  const end = new THREE.Vector3(radius * 1.22, 0, 0);
  made.add(rod(end.clone().negate(), end, radius * 0.05, skin.metal));
  return made;
}
