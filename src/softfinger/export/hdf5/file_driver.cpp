#include "softfinger/export/hdf5/file_driver.hpp"

#include <unistd.h>
#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>  // since HDF5 1.14
#endif

#include <algorithm>
#include <cstring>
#include <memory>

namespace softfinger {
namespace {

/// An open file; HDF5 has what it needs at the front.
struct OpenOutput : H5FD_t {
  explicit OpenOutput(Hdf5Output& to) : H5FD_t{}, output(to) {}
  Hdf5Output& output;
  haddr_t allocated = 0;  ///< bytes
};

OpenOutput& of(H5FD_t* file) { return *static_cast<OpenOutput*>(file); }
const OpenOutput& of(const H5FD_t* file) { return *static_cast<const OpenOutput*>(file); }

H5FD_t* open_output(const char*, unsigned, hid_t access, haddr_t) {
  const auto* const output = static_cast<Hdf5Output* const*>(H5Pget_driver_info(access));
  return output == nullptr ? nullptr : std::make_unique<OpenOutput>(**output).release();
}

herr_t close_output(H5FD_t* file) {
  const std::unique_ptr<OpenOutput> closed(&of(file));
  return 0;
}

herr_t query_output(const H5FD_t*, unsigned long* features) {
  *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA |
              H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DATA_SIEVE;
  return 0;
}

haddr_t end_of_allocated(const H5FD_t* file, H5FD_mem_t) { return of(file).allocated; }

herr_t set_end_of_allocated(H5FD_t* file, H5FD_mem_t, haddr_t size) {
  of(file).allocated = size;
  return 0;
}

haddr_t end_of_output(const H5FD_t* file, H5FD_mem_t) { return of(file).output.end; }

/// What was never written is zeros.
herr_t read_output(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* buffer) {
  auto* bytes = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got =
        ::pread(of(file).output.file.descriptor(), bytes, size, static_cast<off_t>(at));
    if (got < 0) return -1;
    if (got == 0) break;
    bytes += got;
    at += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  std::memset(bytes, 0, size);
  return 0;
}

herr_t write_output(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, const void* buffer) {
  Hdf5Output& output = of(file).output;
  output.failed = output.failed || !output.file.write(buffer, size, at);
  output.end = std::max(output.end, at + size);
  return 0;
}

/// The file ends where HDF5 says.
herr_t truncate_output(H5FD_t* file, hid_t, hbool_t) {
  Hdf5Output& output = of(file).output;
  output.end = of(file).allocated;
  output.failed =
      output.failed || ::ftruncate(output.file.descriptor(), static_cast<off_t>(output.end)) != 0;
  return 0;
}

H5FD_class_t driver_class() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED);  // one that is not registered
#endif
  driver.name = "softfinger_output";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_STRONG;
  // NOLINTNEXTLINE(bugprone-sizeof-expression): the pointer itself is handed on
  driver.fapl_size = sizeof(Hdf5Output*);
  driver.open = open_output;
  driver.close = close_output;
  driver.query = query_output;
  driver.get_eoa = end_of_allocated;
  driver.set_eoa = set_end_of_allocated;
  driver.get_eof = end_of_output;
  driver.read = read_output;
  driver.write = write_output;
  driver.truncate = truncate_output;
  constexpr H5FD_mem_t kKinds[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kKinds), std::end(kKinds), driver.fl_map);
  return driver;
}

}  // namespace

Hdf5Handle access_to(Hdf5Output& output) {
  static const H5FD_class_t kDriver = driver_class();
  const Hdf5Handle driver(H5FDregister(&kDriver), H5FDunregister);
  Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const Hdf5Output* const to = &output;
  hdf5_check(H5Pset_driver(access.id(), driver.id(), &to));
  // Older formats hold times; HDF5 1.8 (2008) and newer read this one.
  hdf5_check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18));
  return access;
}

}  // namespace softfinger
