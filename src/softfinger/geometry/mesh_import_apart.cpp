#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <new>
#include <span>

#include "softfinger/base/error.hpp"
#include "softfinger/geometry/mesh_import.hpp"

namespace softfinger {
namespace {

/// Of processor time; well-formed meshes take a tenth. Importers have loops that do not end on
/// others.
constexpr rlim_t kLeastSeconds = 3;
constexpr rlim_t kSecondsAMegabyte = 2;
constexpr rlim_t kMostMemory = rlim_t{12} << 30;

// Sanitizers reserve more address space than there is memory.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif
#else
constexpr bool kSanitized = false;
#endif

enum class Outcome : std::uint64_t { kMesh = 1, kRefused = 2, kOutOfMemory = 3 };

struct Header {
  Outcome outcome;
  std::uint64_t positions;  ///< or the refusal's length
  std::uint64_t triangles;
};

bool write_all(int pipe, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = ::write(pipe, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool read_all(int pipe, void* data, std::size_t size) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = ::read(pipe, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

void bound(int resource, rlim_t limit) {
  rlimit old{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &old) == 0 && old.rlim_max < limit) {
    limit = old.rlim_max;
  }
  const rlimit bounds{limit, limit};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &bounds);
}

[[noreturn]] void serve(int pipe, MeshFormat format, const std::string& name,
                        const MeshFiles& files) {
  // What this process says is said through the pipe; Ctrl-C is the parent's to answer.
  ::close(STDOUT_FILENO);
  ::close(STDERR_FILENO);
  ::signal(SIGINT, SIG_IGN);
  for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(crash, SIG_DFL);
  bound(RLIMIT_CORE, 0);
  std::size_t bytes = 0;
  for (const auto& [path, content] : files) bytes += content.size();
  bound(RLIMIT_CPU, kLeastSeconds + kSecondsAMegabyte * (bytes >> 20));
  if (!kSanitized) bound(RLIMIT_AS, kMostMemory);
  bool told = false;
  try {
    const TriangleMesh mesh = import_mesh(format, name, files);
    const Header header{Outcome::kMesh, mesh.positions.size(), mesh.triangles.size()};
    told =
        write_all(pipe, &header, sizeof header) &&
        write_all(pipe, mesh.positions.data(), mesh.positions.size() * sizeof(Vector3)) &&
        write_all(pipe, mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
  } catch (const MeshRefusal& refusal) {
    const Header header{Outcome::kRefused, refusal.message.size(), 0};
    told = write_all(pipe, &header, sizeof header) &&
           write_all(pipe, refusal.message.data(), refusal.message.size());
  } catch (const std::bad_alloc&) {
    const Header header{Outcome::kOutOfMemory, 0, 0};
    told = write_all(pipe, &header, sizeof header);
  } catch (...) {
    told = false;
  }
  ::_exit(told ? 0 : 1);
}

TriangleMesh receive(int pipe, MeshFormat format) {
  const auto broken = [&] {
    return MeshRefusal{fmt::format("is broken: reading it as {} failed", name_of(format))};
  };
  Header header{};
  if (!read_all(pipe, &header, sizeof header)) throw broken();
  TriangleMesh mesh;
  switch (header.outcome) {
    case Outcome::kMesh:
      if (header.positions > 3 * kMostTriangles || header.triangles > kMostTriangles)
        throw broken();
      mesh.positions.resize(header.positions);
      mesh.triangles.resize(header.triangles);
      if (!read_all(pipe, mesh.positions.data(), mesh.positions.size() * sizeof(Vector3)) ||
          !read_all(pipe, mesh.triangles.data(),
                    mesh.triangles.size() * sizeof(mesh.triangles[0]))) {
        throw broken();
      }
      return mesh;
    case Outcome::kRefused: {
      std::string message(std::min<std::uint64_t>(header.positions, 1000), ' ');
      if (!read_all(pipe, message.data(), message.size())) throw broken();
      throw MeshRefusal{message};
    }
    case Outcome::kOutOfMemory:
      throw MeshRefusal{fmt::format("needs more than {} GB to be read", kMostMemory >> 30)};
  }
  throw broken();
}

}  // namespace

TriangleMesh import_mesh_apart(MeshFormat format, const std::string& name, const MeshFiles& files) {
  int ends[2];
  if (::pipe(ends) != 0) throw OperationError("no pipe to read a mesh through");
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw OperationError("no process to read a mesh in");
  }
  if (child == 0) {
    ::close(ends[0]);
    serve(ends[1], format, name, files);
  }
  ::close(ends[1]);
  // Waits whatever comes: no process is left behind.
  struct Guard {
    int pipe;
    pid_t child;
    ~Guard() {
      ::close(pipe);
      while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  } const guard{ends[0], child};
  return receive(ends[0], format);
}

}  // namespace softfinger
