#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace softfinger {

/// Streaming 64-bit hash (XXH64, seed 0) over the bytes of values: the same bytes in the same order
/// give the same hash on every run. Copyable; allocates nothing.
class Hash {
 public:
  Hash();

  /// Takes in the bytes of `values`; their type must have no padding.
  template <typename T>
  requires std::is_trivially_copyable_v<T> Hash& add(std::span<const T> values) {
    add_bytes(std::as_bytes(values));
    return *this;
  }
  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) Hash& add(const T& value) {
    return add(std::span<const T>(&value, 1));
  }
  /// Eigen matrices and vectors of fixed size: their coefficients.
  template <typename Matrix>
  requires(Matrix::SizeAtCompileTime > 0) Hash& add(const Matrix& matrix) {
    return add(std::span<const typename Matrix::Scalar>(
        matrix.data(), static_cast<std::size_t>(Matrix::SizeAtCompileTime)));
  }
  void add_bytes(std::span<const std::byte> bytes) {
    if (bytes.empty()) return;  // its data may be null, which memcpy must not be given
    const bool fits =
        bytes.size() <= waiting_.size() && waiting_count_ <= waiting_.size() - bytes.size();
    if (!fits) return take_in(bytes);
    std::memcpy(waiting_.data() + waiting_count_, bytes.data(), bytes.size());
    waiting_count_ += bytes.size();
  }

  [[nodiscard]] std::uint64_t value() const;

 private:
  /// What waits, and then these.
  void take_in(std::span<const std::byte> bytes);

  alignas(8) std::array<std::byte, 88> state_;  // XXH64_state_t
  // Most values are small: they wait for company.
  std::array<std::byte, 1024> waiting_;
  std::size_t waiting_count_ = 0;
};

}  // namespace softfinger
