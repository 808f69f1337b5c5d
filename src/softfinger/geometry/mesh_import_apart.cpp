#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
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
/// Of wall time for one of processor time: the machine may be busy.
constexpr int kWallTimes = 10;
/// How late it may be noticed that nobody wants the mesh any more.
constexpr std::chrono::milliseconds kLookInterval{50};

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

/// The end of the pipe that a mesh comes out of.
class Source {
 public:
  Source(int pipe, const ImportLimits& limits, std::chrono::milliseconds longest)
      : pipe_(pipe), stop_(limits.stop), longest_(longest), deadline_(Clock::now() + longest) {}

  /// False where the pipe ends before. Throws MeshRefusal when time is over or nobody waits.
  bool read(void* data, std::size_t size) const {
    char* at = static_cast<char*>(data);
    while (size > 0) {
      wait();
      const ssize_t got = ::read(pipe_, at, size);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void wait() const {
    pollfd readable{pipe_, POLLIN, 0};
    while (true) {
      if (stop_.stop_requested()) throw MeshRefusal{"is no longer wanted"};
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now());
      if (left.count() <= 0) {
        throw MeshRefusal{fmt::format("could not be read within {} s",
                                      std::chrono::duration<double>(longest_).count())};
      }
      if (::poll(&readable, 1, static_cast<int>(std::min(left, kLookInterval).count())) > 0) return;
    }
  }

  int pipe_;
  std::stop_token stop_;
  std::chrono::milliseconds longest_;
  Clock::time_point deadline_;
};

std::size_t size_of(const MeshFiles& files) {
  std::size_t bytes = 0;
  for (const auto& [path, content] : files) bytes += content.size();
  return bytes;
}

rlim_t processor_seconds(const MeshFiles& files) {
  return kLeastSeconds + kSecondsAMegabyte * (size_of(files) >> 20);
}

void bound(int resource, rlim_t limit) {
  rlimit old{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &old) == 0 && old.rlim_max < limit) {
    limit = old.rlim_max;
  }
  const rlimit bounds{limit, limit};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &bounds);
}

/// The process's whole life. What was copied may be locked by threads that were not: until the
/// import only system calls are made. The import itself allocates, which glibc's fork leaves
/// usable; taken for granted is that it needs no other lock that a thread of this program may hold.
[[noreturn]] void serve(int pipe, pid_t parent, MeshFormat format, const std::string& name,
                        const MeshFiles& files) {
  // Nothing outlives the thread that waits for it, nor keeps open what others must see closed: a
  // guard knows by its socket that the program has ended.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it had ended before
  if (pipe > 0) ::close_range(0, static_cast<unsigned>(pipe) - 1, 0);
  ::close_range(static_cast<unsigned>(pipe) + 1, ~0U, 0);
  ::signal(SIGINT, SIG_IGN);  // Ctrl-C is the parent's to answer
  for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(crash, SIG_DFL);
  bound(RLIMIT_CORE, 0);
  bound(RLIMIT_CPU, processor_seconds(files));
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

TriangleMesh receive(const Source& source, MeshFormat format) {
  const auto broken = [&] {
    return MeshRefusal{fmt::format("is broken: reading it as {} failed", name_of(format))};
  };
  Header header{};
  if (!source.read(&header, sizeof header)) throw broken();
  TriangleMesh mesh;
  switch (header.outcome) {
    case Outcome::kMesh:
      if (header.positions > 3 * kMostTriangles || header.triangles > kMostTriangles)
        throw broken();
      mesh.positions.resize(header.positions);
      mesh.triangles.resize(header.triangles);
      if (!source.read(mesh.positions.data(), mesh.positions.size() * sizeof(Vector3)) ||
          !source.read(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]))) {
        throw broken();
      }
      return mesh;
    case Outcome::kRefused: {
      std::string message(std::min<std::uint64_t>(header.positions, 1000), ' ');
      if (!source.read(message.data(), message.size())) throw broken();
      throw MeshRefusal{message};
    }
    case Outcome::kOutOfMemory:
      throw MeshRefusal{fmt::format("needs more than {} GB to be read", kMostMemory >> 30)};
  }
  throw broken();
}

}  // namespace

TriangleMesh import_mesh_apart(MeshFormat format, const std::string& name, const MeshFiles& files,
                               const ImportLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw OperationError("no pipe to read a mesh through");
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw OperationError("no process to read a mesh in");
  }
  if (child == 0) serve(ends[1], parent, format, name, files);
  ::close(ends[1]);
  // Ends it and waits whatever comes: no process is left behind.
  struct Guard {
    int pipe;
    pid_t child;
    ~Guard() {
      ::close(pipe);
      ::kill(child, SIGKILL);
      while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  } const guard{ends[0], child};
  const std::chrono::seconds usual(kWallTimes * processor_seconds(files));
  return receive(Source(ends[0], limits, limits.longest.value_or(usual)), format);
}

}  // namespace softfinger
