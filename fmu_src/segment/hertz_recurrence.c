#include "segment/hertz_recurrence.h"

/* Coefficient i of a polynomial of time, C or W, of which `terms` count. */
static double hertz_along_time(const struct pair_hertz *p, const struct hertz_recurrence *z,
                               double a[][HERTZ_DIMENSIONS], int terms, int j, int i)
{
    double sum = (i == 0 ? a[0][j] : 0.0) + (terms > 1 ? a[1][j] * p->time[i] : 0.0);
    for (int k = 2; k < terms; ++k) {
        sum += a[k][j] * z->power[k][i];
    }
    return sum;
}

/* The parts of products at one order that come from lower ones. */
struct hertz_sums {
    double time2, square, fourth, drag, speed;
    double n[HERTZ_DIMENSIONS], push[HERTZ_DIMENSIONS], r[HERTZ_DIMENSIONS];
};

/* Where a row backwards has the factors of the coefficients 1, 2, ... of another in their product's
 * coefficient i. */
static inline const double *back_from(const double *back, int i)
{
    return back + (TAYLOR_ORDER - i);
}

/* Of scalars, all in one loop, so that none waits for another. Its last pair may hold the first coefficient
 * that is not known: zero so far, as is what it is multiplied with. */
static inline void hertz_lower_scalars(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       struct hertz_sums *sum)
{
    const double *times = back_from(z->time_back, i);
    const double *roots = back_from(z->root_back, i);
    const double *squares = back_from(z->square_back, i);
    const double *rates = back_from(z->rate_back, i);
    double2 time2 = {0.0};
    double2 square = {0.0};
    double2 fourth = {0.0};
    double2 drag = {0.0};
    for (int k = 1; k < i; k += LANES) {
        time2 += double2_at(p->time, k) * double2_at(times, k);
        square += double2_at(p->root, k) * double2_at(roots, k);
        fourth += double2_at(z->square, k) * double2_at(squares, k);
        drag += double2_at(z->fourth, k) * double2_at(rates, k);
    }
    sum->time2 = lanes_together(time2);
    sum->square = lanes_together(square);
    sum->fourth = lanes_together(fourth);
    sum->drag = lanes_together(drag);
}

/* Of vectors, all components in one loop: they share factors. */
static inline void hertz_lower_vectors(const struct pair_hertz *p, const struct hertz_recurrence *z, int i,
                                       int dimensions, struct hertz_sums *sum)
{
    double2 r[HERTZ_DIMENSIONS];
    double2 n[HERTZ_DIMENSIONS];
    double2 push[HERTZ_DIMENSIONS];
    double2 speed = {0.0};
    for (int j = 0; j < dimensions; ++j) {
        r[j] = n[j] = push[j] = speed;
    }
    for (int k = 1; k < i; k += LANES) {
        const double2 root = double2_at(p->root, k);
        const double2 d = double2_at(z->d, k);
        const double2 impulse = double2_at(z->impulse, k);
        for (int j = 0; j < dimensions; ++j) {
            r[j] += root * double2_at(back_from(z->r_rate_back[j], i), k);
            if (dimensions > 1) {
                const double2 normal = double2_at(back_from(z->n_back[j], i), k);
                n[j] += d * normal;
                push[j] += impulse * normal;
                speed += double2_at(z->w[j], k) * normal;
            }
        }
    }
    for (int j = 0; j < dimensions; ++j) {
        sum->r[j] = lanes_together(r[j]);
        sum->n[j] = lanes_together(n[j]);
        sum->push[j] = lanes_together(push[j]);
    }
    sum->speed = lanes_together(speed);
}

/* Coefficient i of the derivative of c along n, where W is another. */
static double hertz_closing(const struct pair_hertz *p, struct hertz_recurrence *z, int i, int dimensions)
{
    double closing = 0.0;
    for (int j = 0; j < dimensions; ++j) {
        double rate = p->r_rate[j][i];
        for (int k = 1; k <= p->flight.degree; ++k) {
            const double power = k == 1 ? (i == 0) : k == 2 ? p->time[i] : z->power[k - 1][i];
            rate += k * p->flight.c[k][j] * power;
        }
        z->c_rate[j][i] = rate;
        for (int k = 0; k <= i; ++k) {
            closing += z->n[j][k] * z->c_rate[j][i - k];
        }
    }
    return closing;
}

/* What is known while the code is made: fewer dimensions, a lower degree and no mismatch cost less. */
struct hertz_kind {
    int dimensions, degree;
    bool has_mismatch;
    bool first; /* order zero, of which the first and the last term of a product are one */
};

/* Coefficient i of d, n, w and of both rates of the gap, from those of t, u, r and r'. */
static inline void hertz_geometry(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                  const struct hertz_sums *sum, struct hertz_kind kind)
{
    const struct contact_pair *from = p->from;
    const double side = from->shape.side;
    double speed = kind.dimensions > 1 ? sum->speed : 0.0;
    for (int k = 2; k <= kind.degree; ++k) {
        z->power[k][i] = k == 2 ? sum->time2 : series_product(z->power[k - 1], p->time, i);
    }
    z->square[i] = sum->square + (kind.first ? 1.0 : 2.0) * p->root[0] * p->root[i];
    z->d[i] = kind.first ? from->distance : -side * z->square[i];
    for (int j = 0; j < kind.dimensions; ++j) {
        z->w[j][i] = hertz_along_time(p, z, p->flight.w, kind.degree, j, i) + p->r_rate[j][i];
        z->n[j][i] = kind.first && j == 0 ? 1.0 : 0.0;
        if (kind.dimensions > 1 && !kind.first) {
            const double c = hertz_along_time(p, z, p->flight.c, kind.degree + 1, j, i) + p->r[j][i];
            z->n[j][i] = (c - sum->n[j] - z->d[i] * z->n[j][0]) * z->inverse_distance;
            speed += z->n[j][i] * z->w[j][0];
        }
    }
    speed += z->w[0][i]; /* n[0] is the first direction of the frame */
    p->rate[i] = kind.first && !isnan(from->carried_rate) ? from->carried_rate : side * speed;
    z->opening[i] = !kind.has_mismatch ? p->rate[i]

                    : kind.first ? pair_gap_derivative(from)
                                 : side * hertz_closing(p, z, i, kind.dimensions);
    if (kind.has_mismatch && kind.first) {
        (void)hertz_closing(p, z, 0, kind.dimensions);
    }
}

/* 1 / i: a division would keep the next order waiting. */
#define RECIPROCALS(i) 1.0 / (i), 1.0 / ((i) + 1), 1.0 / ((i) + 2), 1.0 / ((i) + 3)
static const double reciprocal[TAYLOR_TERMS] = {
    0.0, RECIPROCALS(1), RECIPROCALS(5), RECIPROCALS(9), RECIPROCALS(13), RECIPROCALS(17), RECIPROCALS(21)};

/* Coefficient i of u^4, of the dashpot's part of u F_n, and of u F_n. */
static inline void hertz_impulse(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                                 const struct hertz_sums *sum, struct hertz_kind kind)
{
    const struct contact_pair *from = p->from;
    const double both = kind.first ? 0.0 : 1.0;
    z->fourth[i] = sum->fourth + (1.0 + both) * z->square[0] * z->square[i];
    const double drag = sum->drag + z->fourth[i] * p->rate[0] + both * z->fourth[0] * p->rate[i];
    p->drag[i] = from->hertz_stiffness * from->chi * drag;
    z->impulse[i] = from->hertz_stiffness * z->fourth[i] - p->drag[i];
}

/* Coefficient i + 1 of t, u, r and r'. */
static inline void hertz_next(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                              const struct hertz_sums *sum, struct hertz_kind kind)
{
    const double both = kind.first ? 0.0 : 1.0;
    const double unit = p->unit * reciprocal[i + 1];
    p->time[i + 1] = unit * p->root[i];
    p->root[i + 1] = -0.5 * unit * z->opening[i];
    for (int j = 0; j < kind.dimensions; ++j) {
        const double push = kind.dimensions == 1 ? z->impulse[i]
                                                 : sum->push[j] + z->impulse[i] * z->n[j][0] +
                                                       both * z->impulse[0] * z->n[j][i];
        p->r[j][i + 1] = unit * (sum->r[j] + p->root[0] * p->r_rate[j][i]);
        p->r_rate[j][i + 1] = unit * (z->side_by_mass * push);
    }
}

/* What the sums of the next order read: rows backwards, but for their first coefficients, and zeros where the
 * sums reach beyond what is known. */
static inline void hertz_note(struct pair_hertz *p, struct hertz_recurrence *z, int i, struct hertz_kind kind)
{
    const int back = TAYLOR_ORDER - i;
    z->time_back[back] = kind.first ? 0.0 : p->time[i];
    z->root_back[back] = kind.first ? 0.0 : p->root[i];
    z->square_back[back] = kind.first ? 0.0 : z->square[i];
    z->rate_back[back] = kind.first ? 0.0 : p->rate[i];
    z->square[i + 1] = z->fourth[i + 1] = z->d[i + 1] = z->impulse[i + 1] = 0.0;
    for (int j = 0; j < kind.dimensions; ++j) {
        z->n_back[j][back] = kind.first ? 0.0 : z->n[j][i];
        z->r_rate_back[j][back] = kind.first ? 0.0 : p->r_rate[j][i];
        z->w[j][i + 1] = 0.0;
    }
}

static inline void hertz_order(struct pair_hertz *p, struct hertz_recurrence *z, int i,
                               struct hertz_kind kind)
{
    struct hertz_sums sum;
    hertz_lower_scalars(p, z, i, &sum);
    hertz_lower_vectors(p, z, i, kind.dimensions, &sum);
    hertz_geometry(p, z, i, &sum, kind);
    hertz_impulse(p, z, i, &sum, kind);
    if (i < TAYLOR_ORDER) {
        hertz_next(p, z, i, &sum, kind);
        hertz_note(p, z, i, kind);
    }
}

/* Orders that the recurrence takes in one go: from `begin` up to but without `end`. */
struct hertz_orders {
    int begin, end;
};

static inline void hertz_run(struct pair_hertz *p, struct hertz_recurrence *z, struct hertz_orders orders,
                             struct hertz_kind kind)
{
    if (orders.begin == 0) {
        hertz_order(p, z, 0, (struct hertz_kind){kind.dimensions, kind.degree, kind.has_mismatch, true});
    }
    for (int i = orders.begin > 0 ? orders.begin : 1; i < orders.end; ++i) {
        hertz_order(p, z, i, kind);
    }
}

/* Under constant forces the degree is two at most. */
CONTACT_FLATTEN void hertz_recurrence_run(struct pair_hertz *p, struct hertz_recurrence *z, int begin,
                                          int end)
{
    const struct hertz_flight *flight = &p->flight;
    const struct hertz_orders orders = {begin, end};
    if (flight->degree > 2 || p->from->has_mismatch) {
        const struct hertz_kind any = {flight->dimensions, flight->degree, p->from->has_mismatch, false};
        hertz_run(p, z, orders, any);
    } else if (flight->dimensions == 1) {
        hertz_run(p, z, orders, (struct hertz_kind){1, 2, false, false});
    } else if (flight->dimensions == 2) {
        hertz_run(p, z, orders, (struct hertz_kind){2, 2, false, false});
    } else {
        hertz_run(p, z, orders, (struct hertz_kind){HERTZ_DIMENSIONS, 2, false, false});
    }
}
