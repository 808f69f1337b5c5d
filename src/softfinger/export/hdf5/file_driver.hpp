#pragma once

#include <hdf5.h>

#include "softfinger/export/hdf5/handle.hpp"
#include "softfinger/files/file_beside.hpp"

namespace softfinger {

/// Where HDF5 puts the bytes of a file. Once a write has failed all later ones succeed and do
/// nothing: HDF5 cannot close a file whose disk is full, and then crashes as the program ends.
struct Hdf5Output {
  FileBeside& file;
  haddr_t end = 0;      ///< bytes that were written
  bool failed = false;  ///< so the file is no good
};

/// How H5Fcreate opens a file, whatever its name: into `output`, which must outlive it.
[[nodiscard]] Hdf5Handle access_to(Hdf5Output& output);

}  // namespace softfinger
