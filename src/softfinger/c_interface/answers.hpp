#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "softfinger/base/error.hpp"
#include "softfinger/softfinger.h"

namespace softfinger {

/// Where a line for people goes; cut to its size, nothing where there is none.
struct ErrorText {
  char* text;
  std::size_t size;

  sf_status tell(sf_status status, std::string_view line) const noexcept {
    if (text == nullptr || size == 0) return status;
    const std::size_t length = std::min(line.size(), size - 1);
    std::memcpy(text, line.data(), length);
    text[length] = '\0';
    return status;
  }
};

/// What `work` returns. No exception gets out of the library.
template <typename Work>
sf_status guarded(ErrorText error, Work&& work) noexcept {
  try {
    error.tell(SF_DONE, "");
    return work();
  } catch (const InputError& wrong) {
    return error.tell(SF_BAD_INPUT, wrong.what());
  } catch (const OperationError& failed) {
    return error.tell(SF_FAILED, failed.what());
  } catch (const std::bad_alloc&) {
    return error.tell(SF_FAILED, "there is not enough memory");
  } catch (const std::exception&) {
    return error.tell(SF_FAILED, "the library failed in a way it does not know");
  }
}

/// Options as whoever set their `size` knew them: at least `first` bytes, those that were there
/// from the beginning; what is newer is zero. NULL: all zero. Throws InputError, with `name` of the
/// struct.
template <typename Options>
Options taken(const Options* given, std::size_t first, const char* name) {
  Options options{};
  if (given == nullptr) return options;
  const std::uint32_t size = given->size;
  if (size < first || size > sizeof(Options)) {
    throw InputError(std::string(name) + ".size is " + std::to_string(size) + ": must be sizeof(" +
                     name + "), " + std::to_string(sizeof(Options)) + " in this version");
  }
  std::memcpy(&options, given, size);
  return options;
}

/// At most `capacity` of `count` elements, by element(i).
template <typename Out, typename Element>
void copy_out(std::size_t count, Out* out, std::size_t capacity, std::size_t* told,
              Element&& element) {
  if (told != nullptr) *told = count;
  if (out == nullptr) return;
  for (std::size_t i = 0; i < std::min(count, capacity); ++i) out[i] = element(i);
}

/// A text and its terminating zero, cut to `capacity` bytes.
inline void copy_text(std::string_view text, char* out, std::size_t capacity, std::size_t* told) {
  if (told != nullptr) *told = text.size() + 1;
  (void)ErrorText{out, capacity}.tell(SF_DONE, text);
}

/// Writes as much of `filled` as the caller's struct has room for; its size stays the caller's.
template <typename Struct>
void hand_out(const Struct& filled, Struct* out) {
  const std::uint32_t size = out->size;
  std::memcpy(out, &filled, std::min<std::size_t>(size, sizeof(Struct)));
  out->size = size;
}

/// NULL: empty.
inline std::string text_or_empty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace softfinger
