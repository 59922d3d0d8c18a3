// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/set_observers.h"

#include "common/base/error.h"

namespace coslam {
namespace {

template <class Call>
std::vector<std::string> problems_of(const std::vector<SetObserver*>& observers, Call call) {
  std::vector<std::string> problems;
  for (SetObserver* observer : observers) {
    try {
      call(*observer);
    } catch (const UserError& e) {
      problems.emplace_back(e.what());
    }
  }
  return problems;
}

}  // namespace

void SetObservers::after_set(const SetOutcome& outcome, const ServerView& view) const {
  for (SetObserver* observer : all_) observer->after_set(outcome, view);
}

void SetObservers::idle(const ServerView& view) const {
  for (SetObserver* observer : all_) observer->idle(view);
}

std::vector<std::string> SetObservers::ending(const ServerView& view, const nlohmann::ordered_json& report) const {
  return problems_of(all_, [&](SetObserver& observer) { observer.ending(view, report); });
}

std::vector<std::string> SetObservers::ended(const ServerView& view, const nlohmann::ordered_json& report) const {
  return problems_of(all_, [&](SetObserver& observer) { observer.ended(view, report); });
}

}  // namespace coslam
