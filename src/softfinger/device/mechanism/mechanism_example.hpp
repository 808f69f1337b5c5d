#pragma once

namespace softfinger {

/// Every kind of body, joint, loop, surface and coordinate; MOTOR and RATE are of what drives it.
inline constexpr const char* kMechanismExample = R"toml(
[[body]]
name = "crank"
[[body]]
name = "rocker"
[[body]]
name = "slide"
[[body]]
name = "gimbal"
[[body]]
name = "ball"
[[body]]
name = "cage"
[[body]]
name = "weld"
[[body]]
name = "motor"
[[joint]]
name = "crank"
type = "revolute"
parent = "base"
child = "crank"
[[joint]]
name = "slide"
type = "prismatic"
parent = "crank"
child = "slide"
[[joint]]
name = "rocker"
type = "revolute"
parent = "slide"
child = "rocker"
[[joint]]
name = "gimbal"
type = "universal"
parent = "rocker"
child = "gimbal"
[[joint]]
name = "ball"
type = "spherical"
parent = "gimbal"
child = "ball"
[[joint]]
name = "cage"
type = "free"
parent = "base"
child = "cage"
[[joint]]
name = "weld"
type = "fixed"
parent = "ball"
child = "weld"
[[joint]]
name = "motor"
MOTOR
actuated = true
parent = "base"
child = "motor"
[[loop]]
type = "spherical"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "revolute"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "universal"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "prismatic"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "cylindrical"
body_a = "weld"
body_b = "cage"
[[loop]]
type = "fixed"
body_a = "weld"
body_b = "cage"
[[surface]]
type = "disk"
body = "cage"
radius_mm = 8.0
[[surface]]
type = "sphere"
body = "cage"
radius_mm = 8.0
[[surface]]
type = "capsule"
body = "cage"
radius_mm = 4.0
length_mm = 8.0
[[surface]]
type = "box"
body = "cage"
size_mm = [4.0, 4.0, 4.0]
[[surface]]
type = "pins"
body = "cage"
radius_mm = 0.5
rows = 2
columns = 2
pitch_mm = 2.0
[[surface]]
type = "pins"
body = "cage"
radius_mm = 0.5
[[surface.pin]]
position_mm = [0.0, 0.0, 0.0]
[[surface]]
type = "mesh"
body = "cage"
file = "cap.stl"
unit = "mm"
[[surface]]
type = "mesh"
body = "cage"
file = "cap.glb"
unit = "m"
[configuration]
crank_deg = { joint = "crank" }
slide_mm = { joint = "slide" }
gimbal_deg = { joint = "gimbal", coordinate = "first" }
pitch_deg = { body = "cage", coordinate = "pitch" }
z_mm = { body = "cage", coordinate = "z" }
[limits]
RATE
max_tilt_deg = 30.0
tilt_body = "cage"
[matching]
approach = "z_mm"
)toml";

}  // namespace softfinger
