// Requests to stop that other parts of the program make.
#pragma once

namespace fieldcast::port {

// The session ends as by Ctrl-C; a request before the session begins ends it at its start. Any
// thread.
void request_stop();

}  // namespace fieldcast::port
