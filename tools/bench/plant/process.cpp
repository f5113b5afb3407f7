#include "tools/bench/plant/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

extern char** environ;

namespace fieldcast::bench {

namespace {

std::string path_of(const std::string& program) {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / program).string();
}

}  // namespace

bool has_program(const std::string& program) { return std::filesystem::exists(path_of(program)); }

Process::Process(const std::string& program, const std::vector<std::string>& arguments,
                 const std::string& log_path) {
  const std::string path = path_of(program);
  // The child ends with the bench, even if that is killed, so no bridge keeps its buses.
  std::vector<std::string> words{"setpriv", "--pdeathsig", "TERM", "--", path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log_path.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  const int failed = posix_spawnp(&id_, words[0].c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw std::runtime_error("cannot start " + path);
}

Process::~Process() { stop(); }

void Process::stop() {
  if (id_ <= 0) return;
  kill(id_, SIGTERM);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (waitpid(id_, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > patience) kill(id_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  id_ = -1;
}

double Process::cpu_seconds() const {
  std::ifstream file("/proc/" + std::to_string(id_) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string skipped;
  // proc(5): state is the third field, utime the 14th.
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double Process::resident_mb() const { return bench::resident_mb(id_); }

double resident_mb(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  }
  return 0;
}

ScratchFolder::ScratchFolder() {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "fieldcast-bench-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  path_ = pattern;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  held_ = ends[1];
  // A separate session, because Ctrl-C reaches the process group. It removes twice, because other
  // programs may still write while they end.
  const char* const script = "cat; rm -rf -- \"$0\" 2>/dev/null || { sleep 2; rm -rf -- \"$0\"; }";
  const char* const argv[] = {"sh", "-c", script, path_.c_str(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const int failed =
      posix_spawnp(&remover_, "sh", &files, &attributes, const_cast<char* const*>(argv), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(ends[0]);
  if (failed != 0) throw std::runtime_error("cannot start sh");
}

ScratchFolder::~ScratchFolder() {
  close(held_);
  waitpid(remover_, nullptr, 0);
}

std::string ScratchFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = path_ + '/' + name;
  std::ofstream(path) << text;
  return path;
}

bool wait_for_path(const std::string& path, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!std::filesystem::exists(path)) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

bool wait_for_text(const std::string& path, const std::string& text, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    std::ifstream file(path);
    const std::string all((std::istreambuf_iterator<char>(file)), {});
    if (all.find(text) != std::string::npos) return true;
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

unsigned own_domain() { return 100 + static_cast<unsigned>(getpid()) % 100; }

}  // namespace fieldcast::bench
