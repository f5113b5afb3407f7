// Runs a fuzz target on the files of directories and on mutations of them, with a fixed seed. This
// is the test if the compiler has no libFuzzer.
//
//     fuzz_FAMILY [--mutations N] [--seconds S] FOLDER..
//
// N mutations of each file (2000); with --seconds, repeats with other mutations until the time has
// passed.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void run(const std::vector<std::uint8_t>& input) {
  (void)LLVMFuzzerTestOneInput(input.data(), input.size());
}

void mutate(std::vector<std::uint8_t>& input, std::mt19937& random) {
  for (unsigned edits = 1 + random() % 4; edits > 0; --edits) {
    const std::size_t at = input.empty() ? 0 : random() % input.size();
    const auto byte = static_cast<std::uint8_t>(random());
    switch (random() % 4) {
      case 0:
        if (!input.empty()) input[at] = byte;
        break;
      case 1:
        if (!input.empty()) input[at] ^= static_cast<std::uint8_t>(1u << byte % 8);
        break;
      case 2: input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), byte); break;
      default:
        if (!input.empty()) input.erase(input.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
}

struct Arguments {
  int mutations = 2000;
  std::chrono::seconds duration{};  // 0: once
  std::vector<std::filesystem::path> folders;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string_view text = argv[i];
    if (text == "--mutations" && i + 1 < argc)
      arguments.mutations = std::atoi(argv[++i]);
    else if (text == "--seconds" && i + 1 < argc)
      arguments.duration = std::chrono::seconds{std::atoi(argv[++i])};
    else
      arguments.folders.emplace_back(text);
  }
  return arguments;
}

std::vector<std::vector<std::uint8_t>> read_corpus(const Arguments& arguments) {
  std::vector<std::vector<std::uint8_t>> inputs;
  for (const auto& folder : arguments.folders) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  return inputs;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  const auto inputs = read_corpus(arguments);
  const auto end = std::chrono::steady_clock::now() + arguments.duration;
  std::mt19937 random(1);
  long mutations = 0;
  for (const auto& input : inputs) run(input);
  do {
    for (const auto& input : inputs) {
      for (int i = 0; i < arguments.mutations; ++i, ++mutations) {
        auto mutated = input;
        mutate(mutated, random);
        run(mutated);
      }
      if (arguments.duration.count() > 0 && std::chrono::steady_clock::now() >= end) break;
    }
  } while (!inputs.empty() && std::chrono::steady_clock::now() < end);
  std::printf("%zu corpus files, %ld mutations of them\n", inputs.size(), mutations);
  return inputs.empty() ? 1 : 0;  // an empty corpus tests nothing
}
