// Runs a fuzz target over the files of the folders given, and over FUZZ_MUTATIONS of each from a
// fixed seed: the ordinary test where the compiler has no libFuzzer.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr int kMutationsOfEach = FUZZ_MUTATIONS;

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

}  // namespace

int main(int argc, char** argv) {
  std::mt19937 random(1);
  int files = 0;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<std::uint8_t> input{std::istreambuf_iterator<char>(file), {}};
      ++files;
      run(input);
      for (int round = 0; round < kMutationsOfEach; ++round) {
        auto mutated = input;
        mutate(mutated, random);
        run(mutated);
      }
    }
  }
  std::printf("%d corpus files, %d mutations of each\n", files, kMutationsOfEach);
  return files > 0 ? 0 : 1;  // an empty corpus tests nothing
}
