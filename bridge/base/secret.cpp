#include "bridge/base/secret.hpp"

#include <sodium.h>

#include <cstring>
#include <new>

#include "bridge/base/check.hpp"

namespace fieldcast {
namespace {

void start_sodium() {
  static const int started = sodium_init();  // may be called repeatedly, from any thread
  FIELDCAST_CHECK(started >= 0);
}

}  // namespace

Secret::Secret(std::string_view text) : size_(text.size()) {
  if (text.empty()) return;
  start_sodium();
  auto* memory = static_cast<char*>(sodium_malloc(text.size()));
  if (memory == nullptr) throw std::bad_alloc();
  std::memcpy(memory, text.data(), text.size());
  sodium_mprotect_readonly(memory);
  text_ = {memory, [](const char* old) { sodium_free(const_cast<char*>(old)); }};
}

Secret Secret::taken_from(std::string& text) {
  Secret secret(text);
  wipe(text);
  return secret;
}

bool same_bytes(std::string_view a, std::string_view b) {
  start_sodium();
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

void wipe(std::string& text) {
  // Also overwrites what a longer text has left behind the end.
  text.resize(text.capacity());
  sodium_memzero(text.data(), text.size());
  text.clear();
}

bool secrets_are_locked() {
  start_sodium();
  static const bool locked = [] {
    constexpr std::size_t kTrial = 16 * 4096;  // several secrets, each on its own pages
    void* memory = sodium_malloc(kTrial);
    if (memory == nullptr) return false;
    // sodium_malloc() does not report whether it locked the memory, so this locks it again.
    const bool can = sodium_mlock(memory, kTrial) == 0;
    sodium_free(memory);
    return can;
  }();
  return locked;
}

}  // namespace fieldcast
