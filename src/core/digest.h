#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/geometry.h"
#include "core/parallel.h"

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace clipgs {

/// SHA-256 (FIPS 180-4) of what is added, in order. Numbers count with the bytes that they have in
/// memory, texts and arrays with their length first, so that neighbours cannot be taken for each
/// other.
class Digest {
 public:
  Digest();

  Digest& add_bytes(const void* data, size_t size);
  template <typename T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>)
  Digest& add(T value) {
    return add_bytes(&value, sizeof value);
  }
  Digest& add(std::string_view text);
  template <int N, typename T>
  Digest& add(const glm::vec<N, T>& v) {
    for (int i = 0; i < N; ++i) {
      add(v[i]);
    }
    return *this;
  }

  /// A large array: hashed in pieces on all threads, then the pieces' digests in order. The result
  /// does not depend on the number of threads.
  template <typename T>
    requires std::is_arithmetic_v<T>
  Digest& add(const std::vector<T>& values) {
    constexpr size_t kPiece = size_t{1} << 20;
    add(static_cast<std::uint64_t>(values.size()));
    std::vector<std::string> pieces((values.size() + kPiece - 1) / kPiece);
    parallel_for(values.size(), kPiece, [&](size_t begin, size_t end) {
      pieces[begin / kPiece] = Digest().add_bytes(&values[begin], (end - begin) * sizeof(T)).hex();
    });
    for (const std::string& piece : pieces) {
      add(piece);
    }
    return *this;
  }

  /// 64 hexadecimal digits. Nothing can be added after it.
  std::string hex();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace clipgs
