#include "tools/station/user_watch.hpp"

#include <utility>

namespace fieldcast::web {

std::optional<Role> local_role_of(const StationSpec& spec, std::optional<std::size_t> users) {
  if (!on_loopback(spec.web.listen)) return std::nullopt;
  if (spec.web.local_role) {
    switch (*spec.web.local_role) {
      case LocalRole::kNone: return std::nullopt;
      case LocalRole::kViewer: return Role::kViewer;
      case LocalRole::kOperator: return Role::kOperator;
    }
  }
  if (!spec.store || users == 0u) return Role::kViewer;
  return std::nullopt;
}

UserWatch::UserWatch(boost::asio::io_context& io, const StationSpec& spec, Site& site, Ask ask)
    : spec_(spec), site_(site), ask_(std::move(ask)), timer_(io) {
  site_.set_local_role(local_role_of(spec_, std::nullopt));
}

UserWatch::~UserWatch() = default;

void UserWatch::look() {
  if (!ask_) return;
  ask_([this, alive = std::weak_ptr(alive_)](Users users) {
    if (!alive.expired()) on_users(users);
  });
}

// If the store cannot be read, logins and the local role remain unchanged.
void UserWatch::on_users(const Users& users) {
  if (users) {
    users_ = users->size();
    std::vector<SessionStore::KnownUser> known;
    for (const User& user : *users) known.push_back({user.name, user.role, user.created_at});
    site_.book().users_are(known);
  }
  site_.set_local_role(local_role_of(spec_, users_));
  timer_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(kPeriod));
  timer_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) look();
  });
}

}  // namespace fieldcast::web
