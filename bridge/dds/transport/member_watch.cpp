#include "bridge/dds/transport/member_watch.hpp"

#include <pthread.h>

#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/member_folder.hpp"
#include "bridge/security/pki.hpp"

namespace fieldcast {

namespace {

// Empty if the file cannot be read.
std::string identity_in(const std::string& folder) {
  try {
    return security::read_file(folder + '/' + std::string(security::kIdentity));
  } catch (const security::SecurityError&) { return {}; }
}

UtcTime utc_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
}

}  // namespace

MemberWatch::MemberWatch(std::string folder, std::shared_ptr<IncomingFilter> filter,
                         dds::DomainParticipant& participant)
    : folder_(std::move(folder)),
      filter_(std::move(filter)),
      participant_(participant),
      identity_(identity_in(folder_)) {
  thread_ = std::thread([this] { run(); });
}

MemberWatch::~MemberWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void MemberWatch::run() {
  pthread_setname_np(pthread_self(), "members");
  std::unique_lock lock(mutex_);
  Instant before = boot_now();
  do {
    const Instant now = boot_now();
    look_at_pause(now - std::exchange(before, now));
    read_list();
    look_at_identity();
    look_at_refused();
  } while (!changed_.wait_for(lock, kPeriod, [this] { return ends_; }));
}

void MemberWatch::look_at_pause(Duration pause) {
  if (pause < kParticipantLease) return;
  say_security(true,
               "this program was suspended for " +
                   to_text(std::chrono::floor<std::chrono::seconds>(pause)) +
                   ": other members do not hear it until it joins the domain again; a service does "
                   "that by itself, start other programs again");
  report_removed();
}

bool MemberWatch::has_new_identity() const {
  const std::string identity = identity_in(folder_);
  return !identity.empty() && identity != identity_ &&
         security::check_member(folder_, utc_now()).faults.empty();
}

// Reports a renewed certificate when two checks have seen it: files may still be copied.
void MemberWatch::look_at_identity() {
  if (renewed_ >= 2) return;
  renewed_ = has_new_identity() ? renewed_ + 1 : 0;
  if (renewed_ == 2) {
    say_security(false, folder_ +
                            " has a renewed certificate; this program takes it when it starts "
                            "again, a bridge also at a reload (SIGHUP)");
  }
}

// Reports the first, tenth, hundredth message and so on: an outsider cannot flood the log.
void MemberWatch::look_at_refused() {
  const std::uint64_t refused = filter_->refused_in_clear();
  if (refused < say_refused_) return;
  while (say_refused_ <= refused) say_refused_ *= 10;
  say_security(false, "messages in clear were refused, " + std::to_string(refused) +
                          " so far: somebody sends under the name of a member, or as none");
}

void MemberWatch::read_list() {
  const auto text = [this](std::string_view file) {
    return security::read_file(folder_ + '/' + std::string(file));
  };
  try {
    std::string list = text(security::kRevoked);
    if (list != list_) {
      for (const auto& subject : security::revoked_subjects(text(security::kIdentityCa), list)) {
        for (const ParticipantPrefix& prefix : filter_->refuse(security::guid_start(subject)))
          remove_member(participant_, prefix);
        if (refused_.insert(subject.common_name()).second && !list_.empty())
          say_security(false, subject.text() + " is revoked: it is not let in any more");
      }
      list_ = std::move(list);
    }
    wrong_ = 0;
  } catch (const security::SecurityError& error) {
    // A file that is being copied is complete at the next check.
    if (++wrong_ == 2)
      say_security(true, folder_ + ": " + error.what() + "; the list before it holds");
  }
}

}  // namespace fieldcast
