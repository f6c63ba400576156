// The programs of the graphics card. Lengths are metres from the middle of the picture until they are divided by its half height.
"use strict";

/** Particles in a row of a table of numbers. */
const TABLE_WIDE = 2048;

const SHADER_HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
`;

/** What all kinds of particles have in common: where one is, whether it is shown, and its colour. */
const SHADER_PARTICLE = `
uniform mat3 u_axes;         // to the right, up, towards the eye
uniform vec3 u_middle;       // middle of the picture from the origin of the run
uniform vec3 u_scale;        // from metres on the page to the window
uniform vec3 u_mirror;       // -1 along the axes that are mirrored
uniform vec3 u_shift;
uniform float u_sign;        // of a component that changes its sign in the mirror
uniform vec4 u_cut;          // normal and offset; what is beyond is left out
uniform sampler2D u_values;  // of the particles, in rows
uniform sampler2D u_body_of;
uniform sampler2D u_bodies;  // distance of the particles of a body, whether it is shown
uniform sampler2D u_map;
uniform vec4 u_range;        // low, high, number of colours of whole values or 0, whether all have one colour
uniform vec3 u_single;
uniform vec3 u_no_value;

vec3 placed(vec3 p) { return p * u_mirror + u_shift; }
vec3 seen(vec3 p) { return (p - u_middle) * u_axes; }
vec4 on_window(vec3 s) { return vec4(s.xy * u_scale.xy, -s.z * u_scale.z, 1.0); }
ivec2 row_of(int k) { return ivec2(k % TABLE_WIDE, k / TABLE_WIDE); }
vec2 body_of(int k) { return texelFetch(u_bodies, ivec2(int(texelFetch(u_body_of, row_of(k), 0).x + 0.5), 0), 0).xy; }
bool is_finite(float x) { return x - x == 0.0; }
bool is_place(vec3 p) { return is_finite(p.x) && is_finite(p.y) && is_finite(p.z); }
vec3 color_of(int k) {
  float number = texelFetch(u_values, row_of(k), 0).x;
  if (!is_finite(number)) return u_no_value;
  if (u_range.w > 0.5) return u_single;
  if (u_range.z > 0.5) return texelFetch(u_map, ivec2(int(clamp(number + 0.5, 0.0, u_range.z - 0.5)), 0), 0).rgb;
  float share = clamp((u_sign * number - u_range.x) / (u_range.y - u_range.x), 0.0, 1.0);
  return texelFetch(u_map, ivec2(int(share * 255.0 + 0.5), 0), 0).rgb;
}
const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
`.replaceAll("TABLE_WIDE", TABLE_WIDE);

/** The number of what was picked, as a colour. */
const SHADER_NUMBER = `
vec4 number_of(int k) {
  uint n = uint(k) + 1u;
  return vec4(float(n & 255u), float((n >> 8) & 255u), float((n >> 16) & 255u), float(n >> 24)) / 255.0;
}
`;

/** A face of the cell of a particle: four vertices each, in order around it. */
const CELL_VERTEX = `${SHADER_HEAD}${SHADER_PARTICLE}
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec4 a_normal; // outward; above zero in the fourth where edges are drawn
layout(location = 2) in uint a_number;
uniform vec3 u_light;
uniform float u_darkest;
uniform float u_shade;  // whether surfaces are lit
uniform float u_edges;  // whether edges of cells are drawn
uniform float u_back;   // whether faces that are turned away are drawn
uniform float u_is_cut; // whether these are where a section cuts cells
out vec2 v_at;          // along both ways of the face
out float v_depth;      // beyond the cut if above zero, m
out float v_lit;
flat out float v_near;  // what is less deep is flat with the cut, m
flat out vec3 v_color;
flat out int v_number;
flat out float v_edges;
void main() {
  int number = int(a_number);
  vec2 body = body_of(number);
  vec3 p = placed(a_position);
  vec3 s = seen(p);
  vec3 outward = a_normal.xyz * u_mirror;
  vec3 normal = outward * u_axes;
  float towards = normal.z;
  if (normal.z < 0.0) normal = -normal;
  int corner = gl_VertexID & 3;
  v_at = vec2(corner == 1 || corner == 2 ? 1.0 : 0.0, corner >= 2 ? 1.0 : 0.0);
  bool has_cut = u_cut.w < 1e29 && u_is_cut < 0.5;
  v_depth = has_cut ? dot(p, u_cut.xyz) - u_cut.w : -1.0;
  // A face along the cut and just before it is as flat as the cut.
  v_near = has_cut && dot(outward, u_cut.xyz) > 0.8 ? 0.4 * body.x : -1e30;
  v_lit = u_shade > 0.5 && u_is_cut < 0.5 ? 1.0 - u_darkest * (1.0 - max(dot(normal, u_light), 0.0) / u_light.z) : 1.0;
  v_color = color_of(number);
  v_number = number;
  v_edges = a_normal.w * u_edges;
  bool is_shown = body.y > 0.5 && (u_back > 0.5 || towards > -0.2);
  gl_Position = is_shown ? on_window(s) : NOWHERE;
}
`;

const CELL_FRAGMENT = `${SHADER_HEAD}${SHADER_NUMBER}
in vec2 v_at;
in float v_depth;
in float v_lit;
flat in float v_near;
flat in vec3 v_color;
flat in int v_number;
flat in float v_edges;
uniform float u_pick;
uniform float u_fine; // pixels of the picture in one of the screen
out vec4 color;
void main() {
  if (v_depth > 0.0) discard;
  if (u_pick > 0.5) { color = number_of(v_number); return; }
  bool is_flat = v_depth > -v_near;
  vec3 lit = v_color * (is_flat ? 1.0 : v_lit);
  if (v_edges > 0.5 && !is_flat) {
    vec2 wide = max(fwidth(v_at), vec2(1e-6)) * u_fine;
    vec2 away = min(v_at, 1.0 - v_at) / wide;
    float cell = 0.5 / max(wide.x, wide.y);
    lit *= 1.0 - 0.28 * (1.0 - smoothstep(0.2, 1.2, min(away.x, away.y))) * smoothstep(2.0, 5.0, cell);
  }
  color = vec4(lit, 1.0);
}
`;

/** A particle whose deformation is not known is a ball, in a plane a disc: six vertices each, without attributes. */
const BALL_VERTEX = `${SHADER_HEAD}${SHADER_PARTICLE}
uniform sampler2D u_positions;
uniform float u_least; // least radius, m
out vec2 v_at;
out float v_radius;
flat out vec3 v_color;
flat out int v_number;
flat out float v_towards;
const vec2 CORNERS[6] = vec2[](vec2(-1.0), vec2(1.0, -1.0), vec2(1.0), vec2(-1.0), vec2(1.0), vec2(-1.0, 1.0));
void main() {
  int number = gl_VertexID / 6;
  vec2 body = body_of(number);
  vec3 p = placed(texelFetch(u_positions, row_of(number), 0).xyz);
  vec3 s = seen(p);
  v_at = CORNERS[gl_VertexID % 6];
  v_radius = max(0.5 * body.x, u_least);
  v_color = color_of(number);
  v_number = number;
  v_towards = s.z;
  // A ball stays whole, or is left out.
  bool is_shown = body.y > 0.5 && is_place(p) && dot(p, u_cut.xyz) <= u_cut.w + 1e-3 * body.x;
  gl_Position = is_shown ? on_window(s + vec3(v_at * v_radius, 0.0)) : NOWHERE;
}
`;

const BALL_FRAGMENT = `${SHADER_HEAD}${SHADER_NUMBER}
in vec2 v_at;
in float v_radius;
flat in vec3 v_color;
flat in int v_number;
flat in float v_towards;
uniform vec3 u_scale;
uniform float u_shade;
uniform float u_pick;
uniform vec3 u_light;
uniform float u_darkest;
out vec4 color;
void main() {
  float from_middle = dot(v_at, v_at);
  if (from_middle > 1.0) discard;
  float rise = sqrt(1.0 - from_middle);
  gl_FragDepth = 0.5 - 0.5 * (v_towards + rise * v_radius) * u_scale.z;
  if (u_pick > 0.5) { color = number_of(v_number); return; }
  vec3 lit = v_color;
  float pixel = fwidth(v_at.x);
  if (u_shade > 0.5) {
    vec3 normal = vec3(v_at, rise);
    lit *= 1.0 - 0.8 * u_darkest * (1.0 - max(dot(normal, u_light), 0.0) / u_light.z);
  } else if (from_middle > 0.38 && pixel < 0.25) {
    lit *= 0.84; // a rim, so that each is seen
  }
  color = vec4(lit, 1.0);
}
`;

/** While many balls move, each is a square of its size. */
const POINT_VERTEX = `${SHADER_HEAD}${SHADER_PARTICLE}
uniform sampler2D u_positions;
uniform float u_pixels; // pixels of a metre
flat out vec3 v_color;
flat out int v_number;
void main() {
  int number = gl_VertexID;
  vec2 body = body_of(number);
  vec3 p = placed(texelFetch(u_positions, row_of(number), 0).xyz);
  bool is_shown = body.y > 0.5 && is_place(p) && dot(p, u_cut.xyz) <= u_cut.w + 1e-3 * body.x;
  gl_Position = is_shown ? on_window(seen(p)) : NOWHERE;
  gl_PointSize = clamp(1.05 * body.x * u_pixels, 1.0, 64.0);
  v_color = color_of(number);
  v_number = number;
}
`;

const POINT_FRAGMENT = `${SHADER_HEAD}${SHADER_NUMBER}
flat in vec3 v_color;
flat in int v_number;
uniform float u_pick;
out vec4 color;
void main() {
  color = u_pick > 0.5 ? number_of(v_number) : vec4(v_color, 1.0);
}
`;

/** Walls, and what marks a place: triangles and lines of one colour. */
const FLAT_VERTEX = `${SHADER_HEAD}
layout(location = 0) in vec3 a_position; // right, up, towards from the middle of the picture, m
uniform vec3 u_scale;
void main() { gl_Position = vec4(a_position.xy * u_scale.xy, -a_position.z * u_scale.z, 1.0); }
`;

const FLAT_FRAGMENT = `${SHADER_HEAD}
uniform vec4 u_color;
out vec4 color;
void main() { color = u_color; }
`;
