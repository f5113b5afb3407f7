#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::bench {

class Arguments {
 public:
  Arguments(int argc, char** argv) : words_(argv + 1, argv + std::max(argc, 1)) {}

  [[nodiscard]] bool has(std::string_view word) const {
    return std::find(words_.begin(), words_.end(), word) != words_.end();
  }
  // The word after `option`. Returns the default if one of the two is missing.
  [[nodiscard]] std::string text(std::string_view option, const std::string& otherwise = {}) const {
    const auto found = std::find(words_.begin(), words_.end(), option);
    return words_.end() - found > 1 ? found[1] : otherwise;
  }
  template <class Number>
  [[nodiscard]] Number number(std::string_view option, Number by_default) const {
    const std::string found = text(option);
    return found.empty() ? by_default : static_cast<Number>(std::strtod(found.c_str(), nullptr));
  }
  // The word at a position, from 0. Returns the default if there are fewer.
  template <class Number>
  [[nodiscard]] Number number_at(std::size_t position, Number by_default) const {
    if (position >= words_.size()) return by_default;
    return static_cast<Number>(std::strtod(words_[position].c_str(), nullptr));
  }
  [[nodiscard]] std::string text_at(std::size_t position) const {
    return position < words_.size() ? words_[position] : std::string{};
  }
  [[nodiscard]] std::size_t size() const { return words_.size(); }

 private:
  std::vector<std::string> words_;
};

// Returns the exit code for main(): 1 after an exception, which it prints.
int run_bench(const char* name, const auto& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}
int run_bench(const char* name, int argc, char** argv, const auto& work) {
  return run_bench(name, [&] { work(Arguments(argc, argv)); });
}

}  // namespace fieldcast::bench
