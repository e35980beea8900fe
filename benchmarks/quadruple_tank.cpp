// The yardstick: quadruple tank, two sampled PI loops with back-calculation, one RK4 step a
// sample, written by hand for speed.
//
// Everything that depends on parameters alone is computed before the time loop, the time step is
// multiplied into it, and the levels enter only through their roots:
//     dh1 = q1 + d1 sqrt(h3) - c1 sqrt(h1),   dh3 = q3 - c3 sqrt(h3), ...
// so that a sample is 16 square roots and little else. Several vectors go side by side, because
// one vector alone would wait for its own roots.
//
// Beside this law of the bare problem stand the same law with all guards that Clepsydra's has
// (`Guarded`), and the bare one with a share of its roots out of multiply-adds (`Refined`).

#include <cmath>
#include <cstddef>

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace {

#if defined(__AVX512F__)
constexpr int vector_bytes = 64;
#elif defined(__AVX__)
constexpr int vector_bytes = 32;
#else
constexpr int vector_bytes = 16;
#endif
constexpr int vector_lanes = vector_bytes / 8;

typedef double Vector __attribute__((vector_size(vector_bytes)));
typedef double UnalignedVector __attribute__((vector_size(vector_bytes), aligned(8), may_alias));

// The lower tanks wait for the roots of the upper ones.
constexpr int upper_first[4] = {2, 3, 0, 1};

constexpr double time_step = 1.0;
constexpr double gravity = 9.81;
constexpr double sensor_gain = 50.0;
constexpr double low_limit = 0.0;
constexpr double high_limit = 10.0;
constexpr double initial_integral = 3.0;
// Below this level the flow is laminar, and above this a number is none [m, -].
constexpr double laminar = 1e-3;
constexpr double largest = 1e300;

// What a program does beyond the bare problem, and how many of the 16 roots multiply-adds compute.
struct Bare {
    static constexpr bool guarded = false;
    static constexpr int refined = 0;
};
struct Guarded : Bare {
    static constexpr bool guarded = true;
};
template <int count>
struct Refined : Bare {
    static constexpr int refined = count;
};

// Rows of the parameter table.
enum Parameter {
    tank_area = 0,
    outlet_area = 4,
    pump_gain = 8,
    split = 10,
    proportional_gain = 12,
    integral_time = 14,
    tracking_time = 16
};

inline Vector broadcast(double value) { return value - Vector{}; }

inline Vector root(Vector x) {
#if defined(__AVX512F__)
    return _mm512_sqrt_pd(x);
#elif defined(__AVX__)
    return _mm256_sqrt_pd(x);
#else
    Vector result;
    for (int lane = 0; lane < vector_lanes; ++lane) result[lane] = __builtin_sqrt(x[lane]);
    return result;
#endif
}

inline Vector larger(Vector a, Vector b) {
#if defined(__AVX512F__)
    return _mm512_max_pd(a, b);
#elif defined(__AVX__)
    return _mm256_max_pd(a, b);
#else
    return a > b ? a : b;
#endif
}

inline Vector smaller(Vector a, Vector b) {
#if defined(__AVX512F__)
    return _mm512_min_pd(a, b);
#elif defined(__AVX__)
    return _mm256_min_pd(a, b);
#else
    return a < b ? a : b;
#endif
}

inline Vector magnitude(Vector x) {
#if defined(__AVX512F__)
    return _mm512_abs_pd(x);
#else
    return larger(x, -x);
#endif
}

// The double next to the root, by a polynomial of third degree and a residual; of numbers that are
// neither near zero nor the largest.
inline Vector refined_root(Vector x) {
#if defined(__AVX512F__)
    const Vector near = _mm512_rsqrt14_pd(x);
    const Vector first = x * near;
    const Vector rest = 1.0 - first * near;
    const Vector share = ((0.3125 * rest + 0.375) * rest + 0.5) * rest;
    const Vector half = 0.5 * near;
    const Vector second = first * share + first;
    return (x - second * second) * (half * share + half) + second;
#else
    return root(x);
#endif
}

inline bool any_below(Vector a, Vector b) {
#if defined(__AVX512F__)
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
#elif defined(__AVX__)
    return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ));
#else
    return _mm_movemask_pd(_mm_cmplt_pd(a, b));
#endif
}
inline Vector where_below(Vector a, Vector b, Vector x, Vector y) { return a < b ? x : y; }
inline Vector where_differs(Vector a, Vector b, Vector x, Vector y) { return a != b ? x : y; }
inline Vector number_or(Vector x, Vector kept) {
    return magnitude(x) <= broadcast(largest) ? x : kept;
}

inline bool any_below(double a, double b) { return a < b; }
inline double where_below(double a, double b, double x, double y) { return a < b ? x : y; }
inline double where_differs(double a, double b, double x, double y) { return a != b ? x : y; }
inline double refined_root(double x) { return __builtin_sqrt(x); }
inline double root(double x) { return __builtin_sqrt(x); }
inline double larger(double a, double b) { return a > b ? a : b; }
inline double smaller(double a, double b) { return a < b ? a : b; }
inline double magnitude(double x) { return __builtin_fabs(x); }
inline double number_or(double x, double kept) { return magnitude(x) <= largest ? x : kept; }

// `count` vectors side by side, for the batch.
template <int count>
struct Lanes {
    Vector part[count];

    Lanes() = default;
    Lanes(double value) {
        for (auto &p : part) p = broadcast(value);
    }
    static constexpr int width = count * vector_lanes;
    static Lanes load(const double *from) {
        Lanes result;
        for (int i = 0; i < count; ++i)
            result.part[i] = *reinterpret_cast<const UnalignedVector *>(from + i * vector_lanes);
        return result;
    }
    void store(double *to) const {
        for (int i = 0; i < count; ++i)
            *reinterpret_cast<UnalignedVector *>(to + i * vector_lanes) = part[i];
    }
    template <class Operation>
    static inline Lanes each(Operation operation) {
        Lanes result;
#pragma GCC unroll 8
        for (int i = 0; i < count; ++i) result.part[i] = operation(i);
        return result;
    }
    friend inline Lanes operator+(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] + b.part[i]; });
    }
    friend inline Lanes operator-(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] - b.part[i]; });
    }
    friend inline Lanes operator*(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] * b.part[i]; });
    }
    friend inline Lanes operator/(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return a.part[i] / b.part[i]; });
    }
    friend inline Lanes root(const Lanes &a) {
        return each([&](int i) { return root(a.part[i]); });
    }
    friend inline Lanes larger(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return larger(a.part[i], b.part[i]); });
    }
    friend inline Lanes smaller(const Lanes &a, const Lanes &b) {
        return each([&](int i) { return smaller(a.part[i], b.part[i]); });
    }
    friend inline Lanes magnitude(const Lanes &a) {
        return each([&](int i) { return magnitude(a.part[i]); });
    }
    friend inline Lanes refined_root(const Lanes &a) {
        return each([&](int i) { return refined_root(a.part[i]); });
    }
    friend inline bool any_below(const Lanes &a, const Lanes &b) {
        bool any = false;
        for (int i = 0; i < count; ++i) any |= any_below(a.part[i], b.part[i]);
        return any;
    }
    friend inline Lanes where_below(const Lanes &a, const Lanes &b, const Lanes &x,
                                    const Lanes &y) {
        return each([&](int i) { return where_below(a.part[i], b.part[i], x.part[i], y.part[i]); });
    }
    friend inline Lanes where_differs(const Lanes &a, const Lanes &b, const Lanes &x,
                                      const Lanes &y) {
        return each(
            [&](int i) { return where_differs(a.part[i], b.part[i], x.part[i], y.part[i]); });
    }
    friend inline Lanes number_or(const Lanes &x, const Lanes &kept) {
        return each([&](int i) { return number_or(x.part[i], kept.part[i]); });
    }
};

// One scenario alone has the same interface as a vector of them.
struct Single {
    static constexpr int width = 1;
    static double load(const double *from) { return *from; }
    static void store(double value, double *to) { *to = value; }
};

template <class Number, class Loader, class Kind = Bare>
struct Loop {
    Number outflow[4], half_outflow[4], sixth_outflow[4];  // dt a / A sqrt(2 g)
    Number upper[2], half_upper[2], sixth_upper[2];        // what an upper tank gives to a lower
    Number inflow[4];  // dt gamma k / A, of the pump that fills the tank
    Number sensor[2], gain[2], integral_gain[2], tracking_gain[2];
    Number level[4], integral[2], absolute_error[2];
    Number voltage[2];
    // With guards: what held last, where something is no number, and the gains of last time.
    Number measured[2], wanted[2], last_gain[2], squared_error[2];

    Loop(const double *parameters, std::size_t stride, const double *initial_levels) {
        auto read = [&](int row) { return Loader::load(parameters + row * stride); };
        Number reciprocal_area[4];
        const Number fall(time_step * std::sqrt(2.0 * gravity));
        for (int tank = 0; tank < 4; ++tank) {
            reciprocal_area[tank] = Number(1.0) / read(tank_area + tank);
            outflow[tank] = fall * read(outlet_area + tank) * reciprocal_area[tank];
            half_outflow[tank] = Number(0.5) * outflow[tank];
            sixth_outflow[tank] = Number(1.0 / 6.0) * outflow[tank];
            level[tank] = Number(initial_levels[tank]);
        }
        for (int loop = 0; loop < 2; ++loop) {
            upper[loop] = fall * read(outlet_area + 2 + loop) * reciprocal_area[loop];
            half_upper[loop] = Number(0.5) * upper[loop];
            sixth_upper[loop] = Number(1.0 / 6.0) * upper[loop];
            const Number flow = Number(time_step) * read(pump_gain + loop);
            const Number share = read(split + loop);
            inflow[loop] = share * flow * reciprocal_area[loop];
            inflow[3 - loop] = (Number(1.0) - share) * flow * reciprocal_area[3 - loop];
            gain[loop] = read(proportional_gain + loop);
            integral_gain[loop] = Number(time_step) * gain[loop] / read(integral_time + loop);
            tracking_gain[loop] = Number(time_step) / read(tracking_time + loop);
            sensor[loop] = Number(sensor_gain);
            integral[loop] = Number(initial_integral);
            absolute_error[loop] = Number(0.0);
            measured[loop] = wanted[loop] = squared_error[loop] = Number(0.0);
            voltage[loop] = Number(initial_integral);
            last_gain[loop] = gain[loop];
        }
    }

    // Sensors and a start of its own: rows as in case.py, INDIVIDUAL.
    void individualise(const double *values, std::size_t stride) {
        for (int loop = 0; loop < 2; ++loop) {
            sensor[loop] = Loader::load(values + loop * stride);
            integral[loop] = Loader::load(values + (6 + loop) * stride);
        }
        for (int tank = 0; tank < 4; ++tank)
            level[tank] = Loader::load(values + (2 + tank) * stride);
    }

    inline void control(const double *setpoint) {
#pragma GCC unroll 2
        for (int loop = 0; loop < 2; ++loop) {
            Number reading = sensor[loop] * level[loop], aim = Number(setpoint[loop]);
            if constexpr (Kind::guarded) {
                // A sensor shows its range; what is no number is held; a new gain makes no bump.
                measured[loop] = reading =
                    number_or(smaller(larger(reading, Number(low_limit)), Number(high_limit)),
                              measured[loop]);
                wanted[loop] = aim = number_or(aim, wanted[loop]);
                const Number change = (last_gain[loop] - gain[loop]) * (aim - reading);
                integral[loop] = where_differs(gain[loop], last_gain[loop],
                                               integral[loop] + change, integral[loop]);
                last_gain[loop] = number_or(gain[loop], last_gain[loop]);
            }
            const Number error = aim - reading;
            const Number unlimited = gain[loop] * error + integral[loop];
            const Number limited =
                smaller(larger(unlimited, Number(low_limit)), Number(high_limit));
            const Number following = integral[loop] + integral_gain[loop] * error +
                                     tracking_gain[loop] * (limited - unlimited);
            absolute_error[loop] = absolute_error[loop] + Number(time_step) * magnitude(error);
            if constexpr (Kind::guarded) {
                squared_error[loop] = squared_error[loop] + Number(time_step) * error * error;
                voltage[loop] = number_or(limited, voltage[loop]);
                integral[loop] = number_or(following, integral[loop]);
            } else {
                voltage[loop] = limited;
                integral[loop] = following;
            }
        }
    }

    // The root of a level at a place in the 16 of a sample; with guards, the laminar law where it is
    // low, which is computed only if some level is.
    static inline Number root_of(const Number &at, int place) {
        if constexpr (Kind::guarded) {
            const Number low(laminar);
            const Number turbulent = root(larger(at, low));
            if (!any_below(at, low)) return turbulent;
            const double scale = std::sqrt(laminar) / laminar;
            const Number first(45.0 / 32.0 * scale), third(-18.0 / 32.0 * scale / laminar / laminar),
                fifth(5.0 / 32.0 * scale / std::pow(laminar, 4));
            const Number size = larger(at, Number(0.0)), square = size * size;
            return where_below(at, low, size * (first + square * (third + square * fifth)),
                               turbulent);
        }
        // Those of the lower tanks, and of the upper ones as far as there are more.
        if (place < Kind::refined) return refined_root(larger(at, Number(1e-200)));
        return root(larger(at, Number(0.0)));
    }

    // Places of the tanks among the roots that are refined first, stage by stage.
    static constexpr int place_of(int tank, int stage) {
        return tank < 2 ? tank * 4 + stage : 8 + (tank - 2) * 4 + stage;
    }

    // The slopes are linear in the roots, so every stage goes straight from roots to levels and
    // only the roots are summed: the shortest chain from one stage to the next.
    inline void drop(const Number (&from)[4], const Number (&roots)[4], const Number (&out)[4],
                     const Number (&up)[2], Number (&to)[4]) const {
#pragma GCC unroll 2
        for (int loop = 0; loop < 2; ++loop) {
            to[loop] = from[loop] + up[loop] * roots[2 + loop] - out[loop] * roots[loop];
            to[2 + loop] = from[2 + loop] - out[2 + loop] * roots[2 + loop];
        }
    }

    inline void integrate() {
        const Number half(0.5), two(2.0);
        Number full[4], halfway[4], at[4], roots[4], sum[4];
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            const Number filled = inflow[tank] * voltage[tank < 2 ? tank : 3 - tank];
            full[tank] = level[tank] + filled;
            halfway[tank] = level[tank] + half * filled;
            roots[tank] = root_of(level[tank], place_of(tank, 0));
            sum[tank] = roots[tank];
        }
        drop(halfway, roots, half_outflow, half_upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            roots[tank] = root_of(at[tank], place_of(tank, 1));
            sum[tank] = sum[tank] + two * roots[tank];
        }
        drop(halfway, roots, half_outflow, half_upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first) {
            roots[tank] = root_of(at[tank], place_of(tank, 2));
            sum[tank] = sum[tank] + two * roots[tank];
        }
        drop(full, roots, outflow, upper, at);
#pragma GCC unroll 4
        for (const int tank : upper_first)
            sum[tank] = sum[tank] + root_of(at[tank], place_of(tank, 3));
        drop(full, sum, sixth_outflow, sixth_upper, level);
    }
};

template <int count, class Kind>
void run_batch(const double *parameters, const double *setpoints, const double *initial_levels,
               const double *individual, std::size_t scenarios, std::size_t samples,
               std::size_t first, std::size_t last, double *final) {
    using Number = Lanes<count>;
    for (std::size_t lane = first; lane < last; lane += Number::width) {
        Loop<Number, Number, Kind> loop(parameters + lane, scenarios, initial_levels);
        if (individual) loop.individualise(individual + lane, scenarios);
        for (std::size_t sample = 0; sample < samples; ++sample) {
            loop.control(setpoints + 2 * sample);
            loop.integrate();
        }
        double *to = final + lane;
        for (int tank = 0; tank < 4; ++tank) loop.level[tank].store(to + tank * scenarios);
        for (int i = 0; i < 2; ++i) {
            loop.integral[i].store(to + (4 + i) * scenarios);
            loop.absolute_error[i].store(to + (6 + i) * scenarios);
        }
    }
}

}  // namespace

extern "C" {

// Scenarios that go side by side with `count` vectors; ranges are multiples of it.
int lanes(int count) { return count * vector_lanes; }

// Scenarios first … last-1 of a batch; parameters [18][scenarios], setpoints [samples][2],
// individual [8][scenarios] or null, final [8][scenarios]. `kind`: 0 for the bare problem, 1 with all guards, 4, 6 or 8 with so many
// refined roots. Returns 0, or 1 where `count` is none of 1, 2, 3, 4 or there is no such kind.
int batch(int kind, int count, const double *parameters, const double *setpoints,
          const double *initial_levels, const double *individual, std::size_t scenarios,
          std::size_t samples, std::size_t first, std::size_t last, double *final) {
    switch (10 * kind + count) {
#define WITH(number, type, n)                                                                  \
    case 10 * number + n:                                                                      \
        run_batch<n, type>(parameters, setpoints, initial_levels, individual, scenarios,       \
                           samples, first, last, final);                                       \
        return 0;
#define WITH_ANY(number, type)                                                                 \
    WITH(number, type, 1) WITH(number, type, 2) WITH(number, type, 3) WITH(number, type, 4)
        WITH_ANY(0, Bare)
#if !defined(ONLY_BARE)  // what is built alone where it is timed how long that takes
        WITH_ANY(1, Guarded)
        WITH_ANY(4, Refined<4>)
        WITH_ANY(6, Refined<6>)
        WITH_ANY(8, Refined<8>)
#endif
#undef WITH_ANY
#undef WITH
    }
    return 1;
}

}  // extern "C"

namespace {

template <class Kind>
void run_single(const double *parameters, const double *setpoints, const double *initial_levels,
                std::size_t samples, double *recorded, double *final) {
    Loop<double, Single, Kind> loop(parameters, 1, initial_levels);
    for (std::size_t sample = 0; sample < samples; ++sample) {
        const double start[4] = {loop.level[0], loop.level[1], loop.level[2], loop.level[3]};
        loop.control(setpoints + 2 * sample);
        double *row = recorded + 6 * sample;
        for (int tank = 0; tank < 4; ++tank) row[tank] = start[tank];
        row[4] = loop.voltage[0];
        row[5] = loop.voltage[1];
        loop.integrate();
    }
    for (int tank = 0; tank < 4; ++tank) final[tank] = loop.level[tank];
    for (int i = 0; i < 2; ++i) {
        final[4 + i] = loop.integral[i];
        final[6 + i] = loop.absolute_error[i];
    }
}

}  // namespace

extern "C" {

// One run; recorded [samples][6] holds the levels and voltages of every sample. `kind`: 0 or 1.
void single(int kind, const double *parameters, const double *setpoints,
            const double *initial_levels, std::size_t samples, double *recorded, double *final) {
#if !defined(ONLY_BARE)
    if (kind == 1) {
        run_single<Guarded>(parameters, setpoints, initial_levels, samples, recorded, final);
        return;
    }
#endif
    (void)kind;
    run_single<Bare>(parameters, setpoints, initial_levels, samples, recorded, final);
}

// As many roots as `steps` scenario-steps need and nothing else, in chains that do not wait for
// each other: no program that takes hardware roots can be faster than this.
void roots_alone(std::size_t steps, double *values) {
    constexpr int chains = 8;
    constexpr std::size_t roots_a_step = 16;
    Lanes<chains> chain = Lanes<chains>::load(values);
    for (std::size_t done = 0; done < steps * roots_a_step; done += Lanes<chains>::width)
        chain = root(chain) + Lanes<chains>(0.1);
    chain.store(values);
}

}  // extern "C"
