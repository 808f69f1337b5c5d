import { Color, DoubleSide, ShaderMaterial, Vector3 } from "three";

export interface GlassOptions {
  color: string;
  body: number; // opacity seen straight on
  rim: number; // and added where it is seen edge-on
  grid: number; // mm between lines; 0: none
  reach?: number; // mm from `centre`, in its own frame, at which it has faded
  deforms?: boolean; // its grid is that of attributes `rest` and `restNormal`, and goes with it
}

/** Thin glass with a bright rim and a grid of its own frame, so that what lies behind is seen. */
export function glass({ color, body, rim, grid, reach = Infinity, deforms = false }: GlassOptions): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    side: DoubleSide,
    defines: deforms ? { DEFORMS: "" } : {},
    uniforms: {
      color: { value: new Color(color) },
      centre: { value: new Vector3() },
      reach: { value: Math.min(reach, 1e6) },
      body: { value: body },
      rim: { value: rim },
      spacing: { value: grid > 0 ? grid : 1e6 },
      gridStrength: { value: grid > 0 ? 1 : 0 },
    },
    vertexShader: /* glsl */ `
      #ifdef DEFORMS
        attribute vec3 rest;
        attribute vec3 restNormal;
      #endif
      varying vec3 vWorld;
      varying vec3 vLocal;
      varying vec3 vLocalNormal;
      varying vec3 vWorldNormal;
      void main() {
        mat4 place = modelMatrix;
        #ifdef USE_INSTANCING
          place = modelMatrix * instanceMatrix;
        #endif
        vec4 world = place * vec4(position, 1.0);
        vWorld = world.xyz;
        #ifdef DEFORMS
          vLocal = rest;
          vLocalNormal = restNormal;
        #else
          vLocal = position;
          vLocalNormal = normal;
        #endif
        vWorldNormal = mat3(place) * normal;
        gl_Position = projectionMatrix * viewMatrix * world;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 color;
      uniform vec3 centre;
      uniform float reach;
      uniform float body;
      uniform float rim;
      uniform float spacing;
      uniform float gridStrength;
      varying vec3 vWorld;
      varying vec3 vLocal;
      varying vec3 vLocalNormal;
      varying vec3 vWorldNormal;
      float lines(float x) {
        float at = abs(fract(x / spacing - 0.5) - 0.5) * spacing;
        float width = fwidth(x);
        return (1.0 - smoothstep(0.0, 1.4 * width, at)) * clamp(0.12 * spacing / width, 0.0, 1.0);
      }
      void main() {
        vec3 toEye = normalize(cameraPosition - vWorld);
        vec3 n = normalize(vWorldNormal);
        if (dot(n, toEye) < 0.0) n = -n;
        float edge = pow(1.0 - dot(n, toEye), 2.5);
        float light = 0.75 + 0.25 * n.z;
        vec3 m = abs(normalize(vLocalNormal));
        float grid = gridStrength *
            max(max(lines(vLocal.x) * (1.0 - m.x), lines(vLocal.y) * (1.0 - m.y)),
                lines(vLocal.z) * (1.0 - m.z));
        float fade = 1.0 - smoothstep(0.35 * reach, reach, distance(vLocal, centre));
        float alpha = (body + rim * edge + 0.16 * grid) * fade;
        gl_FragColor = vec4(color * (light + 0.5 * edge + 0.3 * grid), alpha);
        #include <colorspace_fragment>
      }`,
  });
}
