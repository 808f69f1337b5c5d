#include "softfinger/geometry/mesh_import.hpp"

#include <fmt/format.h>

#include <assimp/BaseImporter.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cstring>
#include <set>
#include <vector>

namespace softfinger {
namespace {

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(const std::string& content) : content_(content) {}

  size_t Read(void* out, size_t size,
              size_t count) override {  // NOLINT
    if (size == 0) return 0;
    count = std::min(count, (content_.size() - at_) / size);
    std::memcpy(out, content_.data() + at_, size * count);
    at_ += size * count;
    return count;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }  // NOLINT
  aiReturn Seek(size_t offset, aiOrigin origin) override {          // NOLINT
    size_t from = 0;
    if (origin == aiOrigin_CUR) from = at_;
    if (origin == aiOrigin_END) from = content_.size();
    const size_t to = origin == aiOrigin_END ? from - offset : from + offset;
    if (to > content_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }                  // NOLINT
  size_t FileSize() const override { return content_.size(); }  // NOLINT
  void Flush() override {}                                      // NOLINT

 private:
  const std::string& content_;
  size_t at_ = 0;
};

/// Only what was read already: nothing a mesh file says opens another file.
class MemoryFiles : public Assimp::IOSystem {
 public:
  explicit MemoryFiles(const MeshFiles& files) : files_(files) {}

  bool Exists(const char* name) const override { return find(name) != files_.end(); }  // NOLINT
  char getOsSeparator() const override { return '/'; }                                 // NOLINT
  Assimp::IOStream* Open(const char* name, const char* mode) override {                // NOLINT
    const auto file = find(name);
    if (file == files_.end() || std::strchr(mode, 'w') != nullptr) return nullptr;
    return new MemoryStream(file->second);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }  // NOLINT

 private:
  [[nodiscard]] MeshFiles::const_iterator find(std::string name) const {
    while (name.starts_with("./")) name.erase(0, 2);
    return files_.find(name);
  }
  const MeshFiles& files_;
};

const char* extension_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return "obj";
    case MeshFormat::kStl:
      return "stl";
    case MeshFormat::kPly:
      return "ply";
    case MeshFormat::kGltf:
      return "gltf";
    case MeshFormat::kGlb:
      return "glb";
  }
  return "";
}

/// Leaves the importers of the format; glTF has two, for versions 1 and 2.
void keep_importers(Assimp::Importer& importer, MeshFormat format) {
  const std::string wanted = extension_of(format);
  std::vector<Assimp::BaseImporter*> others;
  for (std::size_t i = 0; i < importer.GetImporterCount(); ++i) {
    std::set<std::string> extensions;
    importer.GetImporter(i)->GetExtensionList(extensions);
    if (!extensions.contains(wanted)) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) importer.UnregisterLoader(other);
}

void append(const aiMesh& mesh, const aiMatrix4x4& X, TriangleMesh& out) {
  const auto first = static_cast<int>(out.positions.size());
  if (out.positions.size() + mesh.mNumVertices > 3 * kMostTriangles ||
      out.triangles.size() + mesh.mNumFaces > kMostTriangles) {
    throw MeshRefusal{fmt::format("has more than {} triangles", kMostTriangles)};
  }
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const double x = mesh.mVertices[i].x;
    const double y = mesh.mVertices[i].y;
    const double z = mesh.mVertices[i].z;
    out.positions.emplace_back(X.a1 * x + X.a2 * y + X.a3 * z + X.a4,
                               X.b1 * x + X.b2 * y + X.b3 * z + X.b4,
                               X.c1 * x + X.c2 * y + X.c3 * z + X.c4);
  }
  // A mirrored node turns its triangles inside out.
  const bool mirrored = X.Determinant() < 0.0F;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    std::array<int, 3> triangle;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices)
        throw MeshRefusal{"names a vertex it does not have"};
      triangle[k] = first + static_cast<int>(face.mIndices[k]);
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    out.triangles.push_back(triangle);
  }
}

void append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent, int depth,
            TriangleMesh& out) {
  if (depth > 1000) throw MeshRefusal{"its nodes are nested more than 1000 deep"};
  const aiMatrix4x4 X = X_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) append(*scene.mMeshes[node.mMeshes[i]], X, out);
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    append(scene, *node.mChildren[i], X, depth + 1, out);
  }
}

}  // namespace

const char* name_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return "OBJ";
    case MeshFormat::kStl:
      return "STL";
    case MeshFormat::kPly:
      return "PLY";
    case MeshFormat::kGltf:
      return "glTF";
    case MeshFormat::kGlb:
      return "GLB";
  }
  return "";
}

TriangleMesh import_mesh(MeshFormat format, const std::string& name, const MeshFiles& files) {
  TriangleMesh mesh;
  Assimp::Importer importer;
  importer.SetIOHandler(new MemoryFiles(files));  // the importer deletes it
  keep_importers(importer, format);
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw MeshRefusal{fmt::format("cannot be read as {}", name_of(format))};
  }
  append(*scene, *scene->mRootNode, aiMatrix4x4(), 0, mesh);
  return mesh;
}

}  // namespace softfinger
