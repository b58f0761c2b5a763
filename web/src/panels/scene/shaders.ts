/** The programs of the graphics card: how points, lines, solids, meshes and maps become pixels. */

const HEAD = `#version 300 es
precision highp float;
precision highp int;
`;

/** A point outside of the picture, for numbers that are not finite. */
const AWAY = `
bool isFinite(vec3 p) { return all(lessThan(abs(p), vec3(1e9))); }
const vec4 AWAY = vec4(2.0, 2.0, 2.0, 1.0);
`;

const LIGHT = `
vec3 lit(vec3 color, vec3 normal) {
  float light = dot(normalize(normal), normalize(vec3(0.3, 0.6, 0.75)));
  return color * (0.55 + 0.45 * light);
}
`;

const FLAT = `${HEAD}
in vec4 tint;
out vec4 pixel;
void main() { pixel = tint; }
`;

export const SHADERS = {
  points: [
    `${HEAD}${AWAY}
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 bgr;
layout(location = 2) in float number;
uniform mat4 matrix;
uniform vec4 color, axis;
uniform vec2 range;
uniform vec2 size;
uniform int kind, row;
uniform sampler2D palettes;
out vec4 tint;
void main() {
  gl_Position = isFinite(place) ? matrix * vec4(place, 1.0) : AWAY;
  gl_PointSize = size.y == 0.0 ? size.x : max(1.0, size.x * size.y / gl_Position.w);
  if (kind == 0) {
    tint = color;
  } else if (kind == 1) {
    tint = vec4(bgr.bgr, color.a);
  } else {
    float value = kind == 2 ? number : dot(axis, vec4(place, 1.0));
    float ratio = clamp((value - range.x) / (range.y - range.x), 0.0, 1.0);
    tint = vec4(texelFetch(palettes, ivec2(int(ratio * 255.0), row), 0).rgb, color.a);
  }
}
`,
    FLAT,
  ],
  lines: [
    `${HEAD}${AWAY}
layout(location = 0) in vec3 start;
layout(location = 1) in vec3 end;
layout(location = 2) in vec4 startColor;
layout(location = 3) in vec4 endColor;
uniform mat4 matrix;
uniform vec4 color;
uniform vec4 screen;
uniform int hasColors;
out vec4 tint;
void main() {
  vec4 a = matrix * vec4(start, 1.0), b = matrix * vec4(end, 1.0);
  bool atEnd = (gl_VertexID & 1) == 1;
  tint = hasColors == 0 ? color : atEnd ? endColor : startColor;
  // Behind the camera, a line has no direction on the picture.
  float near = 1e-3;
  if (!isFinite(start) || !isFinite(end) || (a.w < near && b.w < near)) {
    gl_Position = AWAY;
    return;
  }
  if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
  else if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * screen.xy;
  float length = max(length(along), 1e-6);
  vec4 place = atEnd ? b : a;
  float width = screen.w == 0.0 ? screen.z : max(1.0, screen.z * screen.w / place.w);
  vec2 across = vec2(-along.y, along.x) / length * width / screen.xy;
  place.xy += across * ((gl_VertexID & 2) == 0 ? 1.0 : -1.0) * place.w;
  gl_Position = place;
}
`,
    FLAT,
  ],
  solids: [
    `${HEAD}${LIGHT}
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 place;
layout(location = 3) in vec4 rotation;
layout(location = 4) in vec3 size;
layout(location = 5) in vec4 color;
uniform mat4 matrix, view;
out vec4 tint;
vec3 rotated(vec3 v) { return v + 2.0 * cross(rotation.xyz, cross(rotation.xyz, v) + rotation.w * v); }
void main() {
  gl_Position = matrix * vec4(place + rotated(corner * size), 1.0);
  vec3 outward = rotated(normal / max(abs(size), vec3(1e-9)) * sign(size));
  tint = vec4(lit(color.rgb, mat3(view) * outward), color.a);
}
`,
    FLAT,
  ],
  mesh: [
    `${HEAD}${LIGHT}
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 own;
uniform mat4 matrix, view;
uniform vec3 scale;
uniform vec4 color;
uniform ivec2 flags;
out vec4 tint;
void main() {
  gl_Position = matrix * vec4(place, 1.0);
  tint = flags.x == 1 ? color * own : color;
  if (flags.y == 0) tint.rgb = lit(tint.rgb, mat3(view) * (normal / scale));
}
`,
    FLAT,
  ],
  grid: [
    `${HEAD}
uniform mat4 matrix;
uniform vec4 box;
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = matrix * vec4(box.xy + at * box.zw, 0.0, 1.0);
}
`,
    `${HEAD}
in vec2 at;
uniform sampler2D cells, palettes;
uniform int row;
uniform float alpha;
out vec4 pixel;
void main() {
  int value = int(texture(cells, at).r * 255.0 + 0.5);
  pixel = texelFetch(palettes, ivec2(value, row), 0);
  pixel.a *= alpha;
}
`,
  ],
} as const;
