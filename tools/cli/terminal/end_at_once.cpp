#include "tools/cli/terminal/end_at_once.hpp"

#include <unistd.h>

#include "tools/cli/terminal/gzip_file.hpp"
#include "tools/cli/text/exit_code.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {

EndAtOnce::EndAtOnce(Duration grace) : grace_(grace) {
  interrupt_.on_raise([this] { end(); });
}

EndAtOnce::~EndAtOnce() {
  {
    const std::lock_guard lock(whole_);
    ended_ = true;
  }
  changed_.notify_all();
  interrupt_.on_raise({});
}

void EndAtOnce::end() {
  std::unique_lock lock(whole_);
  if (changed_.wait_for(lock, grace_, [this] { return ended_; })) return;
  wipe_progress_at_end();
  GzipFile::remove_unfinished();
  ::_exit(to_int(ExitCode::kInterrupted));
}

}  // namespace fieldcast::cli
