#include "softfinger/base/code_hash.hpp"

#include <link.h>

#include <cstddef>
#include <span>

#include "softfinger/base/hash.hpp"

namespace softfinger {
namespace {

struct Search {
  ElfW(Addr) address;  ///< in what is looked for
  std::uint64_t hash = 0;
};

/// Calls `take` with begin and size of each segment that is loaded.
template <typename Take>
void each_loaded(const dl_phdr_info& object, const Take& take) {
  for (ElfW(Half) i = 0; i < object.dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object.dlpi_phdr[i];
    if (segment.p_type == PT_LOAD) take(segment, object.dlpi_addr + segment.p_vaddr);
  }
}

int hash_where_it_is(dl_phdr_info* object, std::size_t, void* asked) {
  Search& search = *static_cast<Search*>(asked);
  bool here = false;
  each_loaded(*object, [&](const ElfW(Phdr) & segment, ElfW(Addr) begin) {
    here = here || (search.address >= begin && search.address < begin + segment.p_memsz);
  });
  if (!here) return 0;
  Hash hash;
  each_loaded(*object, [&](const ElfW(Phdr) & segment, ElfW(Addr) begin) {
    if ((segment.p_flags & PF_W) != 0 || (segment.p_flags & PF_R) == 0) return;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader speaks in numbers
    hash.add_bytes({reinterpret_cast<const std::byte*>(begin), segment.p_filesz});
  });
  search.hash = hash.value();
  return 1;
}

}  // namespace

std::uint64_t code_hash() {
  static const std::uint64_t kValue = [] {
    Search search{reinterpret_cast<ElfW(Addr)>(&code_hash)};
    dl_iterate_phdr(hash_where_it_is, &search);
    return search.hash;
  }();
  return kValue;
}

}  // namespace softfinger
