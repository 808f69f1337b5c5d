#pragma once

#include <filesystem>
#include <string>

#include "softfinger/geometry/triangle_mesh.hpp"

namespace softfinger {

/// An icosahedron with each edge divided by `divisions`, pushed onto a sphere. Closed and outward,
/// as are all meshes here.
TriangleMesh sphere_mesh(double radius, int divisions);
/// About z: `ring` is the radius of the circle the tube of radius `tube` runs along.
TriangleMesh torus_mesh(double ring, double tube, int around, int across);
/// Each edge divided by `divisions`.
TriangleMesh box_mesh(const Vector3& half_size, int divisions = 1);
/// A cube of half size `half` with a square tunnel of half width `hole` along z.
TriangleMesh tunnel_mesh(double half, double hole);
/// A prism along y whose edge, of the given angle (rad), is at x = z = 0 and points to +z.
TriangleMesh wedge_mesh(double angle, double height, double half_length);

TriangleMesh moved(TriangleMesh mesh, const Pose& X);
TriangleMesh inside_out(TriangleMesh mesh);
TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b);

/// Writes the mesh in the format of the extension (.obj, .stl binary, .ply ASCII, .gltf with its
/// buffer inside, .glb), its coordinates divided by `unit`.
void write_mesh(const std::filesystem::path& file, const TriangleMesh& mesh, double unit);
void write_file(const std::filesystem::path& file, const std::string& content);

}  // namespace softfinger
