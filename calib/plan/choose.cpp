#include "calib/plan/choose.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

namespace raysteer::calib::plan {
namespace {

constexpr int kRounds = 4;

/// What a set of looks is judged by: first that no axis lacks levels, then the predictions.
using Merit = std::pair<int, double>;

/// Levels that are missing on both axes.
int missing_levels(std::span<const Candidate> candidates, std::span<const std::size_t> chosen) {
  std::set<int> columns;
  std::set<int> rows;
  for (const std::size_t i : chosen) {
    columns.insert(candidates[i].column);
    rows.insert(candidates[i].row);
  }
  const auto missing = [](const std::set<int>& levels) {
    return std::max(0, kFewestLevels - static_cast<int>(levels.size()));
  };
  return missing(columns) + missing(rows);
}

/// The spread as root root^T, so that a trace is a norm.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& spread) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(spread);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

double squared_error(const Eigen::MatrixXd& precision, const Eigen::MatrixXd& root) {
  const Eigen::LLT<Eigen::MatrixXd> factor(precision);
  return factor.info() == Eigen::Success ? factor.matrixL().solve(root).squaredNorm()
                                         : std::numeric_limits<double>::infinity();
}

class Search {
 public:
  Search(std::span<const Candidate> candidates, const Eigen::MatrixXd& spread)
      : candidates_(candidates),
        root_(root_of(spread)),
        taken_(candidates.size(), false),
        precision_(Eigen::MatrixXd::Identity(spread.rows(), spread.cols())) {}

  void add_best() {
    chosen_.push_back(best_for(chosen_.size()).first);
    take(chosen_.back());
  }

  /// Takes each look out and puts the best one in its place, which may be itself. True when one changed.
  bool exchange() {
    bool changed = false;
    for (std::size_t slot = 0; slot < chosen_.size(); ++slot) {
      const std::size_t old = chosen_[slot];
      const Merit before{missing_levels(candidates_, chosen_), squared_error(precision_, root_)};
      taken_[old] = false;
      precision_ -= candidates_[old].forecast.information;
      auto [better, merit] = best_for(slot);
      // The last digits differ with the order of sums; a gain must be more than that.
      const bool gain =
          merit.first < before.first || (merit.first == before.first && merit.second < before.second * (1 - 1e-9));
      better = gain ? better : old;
      changed = changed || gain;
      chosen_[slot] = better;
      take(better);
    }
    return changed;
  }

  const std::vector<std::size_t>& chosen() const { return chosen_; }

 private:
  void take(std::size_t index) {
    taken_[index] = true;
    precision_ += candidates_[index].forecast.information;
  }

  /// The best look to stand at `slot` besides the others.
  std::pair<std::size_t, Merit> best_for(std::size_t slot) const {
    std::vector<std::size_t> trial = chosen_;
    trial.resize(std::max(trial.size(), slot + 1));
    std::pair<std::size_t, Merit> best{0, {std::numeric_limits<int>::max(), 0}};
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (taken_[i]) {
        continue;
      }
      trial[slot] = i;
      const int missing = missing_levels(candidates_, trial);
      if (missing > best.second.first) {
        continue;
      }
      const Merit merit{missing, squared_error(precision_ + candidates_[i].forecast.information, root_)};
      if (merit < best.second) {
        best = {i, merit};
      }
    }
    return best;
  }

  std::span<const Candidate> candidates_;
  Eigen::MatrixXd root_;
  std::vector<bool> taken_;
  std::vector<std::size_t> chosen_;
  Eigen::MatrixXd precision_;
};

}  // namespace

double mean_squared(const Eigen::MatrixXd& information, const Eigen::MatrixXd& spread) {
  const Eigen::MatrixXd precision = Eigen::MatrixXd::Identity(information.rows(), information.cols()) + information;
  return squared_error(precision, root_of(spread));
}

std::vector<std::size_t> choose(std::span<const Candidate> candidates, const Eigen::MatrixXd& spread,
                                std::size_t count) {
  Search search(candidates, spread);
  for (std::size_t i = 0; i < std::min(count, candidates.size()); ++i) {
    search.add_best();
  }
  for (int round = 0; round < kRounds && search.exchange(); ++round) {
  }
  return search.chosen();
}

}  // namespace raysteer::calib::plan
