// The scheduler of a bus: core/dispatch/scheduler.hpp.
#pragma once

#include "core/dispatch/scheduler.hpp"
