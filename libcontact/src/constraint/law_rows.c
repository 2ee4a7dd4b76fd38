/* The numbers of rows side by side. Four rows are turned into columns at once. */
#include "law_rows.h"

#include "../base/lanes.h"

#include <stddef.h>
#include <string.h>

/* The members of a row that are read, in groups of four that follow on each other from a member on,
 * and the first array of each group; and those that are written. */
#define AT(member) (offsetof(ct_constraint, member) / sizeof(double))
enum { READ = 4, WRITE = 2, RELEASE = 15 };
static const size_t READS[READ][2] = {
    {AT(stiffness), 0}, {AT(gap), 4}, {AT(force), 10}, {AT(impact.pressed), 12}};
static const size_t WRITES[WRITE][2] = {{AT(dashpot), 7}, {AT(impact.reserve), 11}};

/* A member between these does not compile. */
typedef char members_follow_on_each_other[AT(travel_time) == AT(stiffness) + 3 &&
                                                  AT(dashpot) == AT(gap) + 3 &&
                                                  AT(force) == AT(dashpot) + 3 &&
                                                  AT(impact.reserve) == AT(force) + 1 &&
                                                  AT(impact.release) == AT(impact.reserve) + 4
                                              ? 1
                                              : -1];

void ct_law_rows_create(ct_pool *pool, int64_t most, ct_constraint **rows, ct_law_rows *out)
{
  double **numbers[CT_LAW_NUMBERS] = {
      &out->stiffness, &out->dissipation, &out->restitution, &out->travel_time, &out->gap,
      &out->moved,     &out->came,        &out->dashpot,     &out->before,      &out->after,
      &out->force,     &out->reserve,     &out->pressed,     &out->idle,        &out->stored,
      &out->release,   &out->last,        &out->next};
  double *all = out->all = ct_pool_take(pool, (size_t)most, CT_LAW_NUMBERS * sizeof *all);
  out->most = most;
  out->row = rows;
  for (int i = 0; all != NULL && i < CT_LAW_NUMBERS; i++) *numbers[i] = all + i * most;
}

CT_INLINE double *numbers_of(const ct_constraint *c) { return (double *)(uintptr_t)c; }

/* Rows as numbers, and the arrays with the numbers of the first of them. */
typedef struct columns {
  double *row[4];
  double *first;
  int64_t most;
} columns;

CT_INLINE columns columns_of(const ct_law_rows *rows, int64_t r, int count)
{
  columns c = {.first = rows->all + r, .most = rows->most};
  for (int i = 0; i < count; i++) c.row[i] = numbers_of(rows->row[r + i]);
  return c;
}

/* Read the groups from `g` to `end` - 1. */
CT_INLINE void read_four(const columns c, int g, int end)
{
  for (; g < end; g++) {
    const double *from[4];
    double *to[4];
    for (int i = 0; i < 4; i++) {
      from[i] = c.row[i] + READS[g][0];
      to[i] = c.first + ((int64_t)READS[g][1] + i) * c.most;
    }
    ct_turn(from, to);
  }
}

CT_INLINE void read_one(const columns c, int g, int end)
{
  for (; g < end; g++)
    for (int i = 0; i < 4; i++)
      c.first[((int64_t)READS[g][1] + i) * c.most] = c.row[0][READS[g][0] + (size_t)i];
}

/* Read some rows, as far as they are not known; returns 0 if all have the law of the first. */
CT_INLINE unsigned read_some(ct_rows_known known, const ct_law_rows *to, int64_t r, int64_t end)
{
  const int first = known != CT_ROWS_UNKNOWN, last = known == CT_ROWS_WRITTEN ? 2 : READ;
  const unsigned law = r < end ? (unsigned)to->row[0]->enforcement : 0;
  unsigned differing = 0;
  for (; r + 4 <= end; r += 4) {
    for (int i = 0; !known && i < 4; i++) differing |= (unsigned)to->row[r + i]->enforcement ^ law;
    read_four(columns_of(to, r, 4), first, last);
  }
  for (; r < end; r++) {
    differing |= (unsigned)to->row[r]->enforcement ^ law;
    read_one(columns_of(to, r, 1), first, last);
  }
  return differing;
}

CT_CLONES
static unsigned read_rows(ct_rows_known known, const ct_law_rows *to, int64_t first, int64_t end)
{
  if (known == CT_ROWS_WRITTEN) return read_some(CT_ROWS_WRITTEN, to, first, end);
  if (known == CT_ROWS_KNOWN) return read_some(CT_ROWS_KNOWN, to, first, end);
  return read_some(CT_ROWS_UNKNOWN, to, first, end);
}

void ct_law_rows_read(ct_law_rows *to, ct_constraint *const *rows, int64_t first, int64_t end,
                      ct_rows_known known)
{
  to->count = end;
  if (!known) ct_copy(&to->row[first], &rows[first], (size_t)(end - first) * sizeof *rows);
  const int alike = read_rows(known, to, first, end) == 0;
  if (!known) to->one_law = (first == 0 || to->one_law) & alike;
}

void ct_law_rows_move(ct_law_rows *rows, int64_t from, int64_t to)
{
  rows->row[to] = rows->row[from];
  for (int i = 0; i < CT_LAW_NUMBERS; i++)
    rows->all[i * rows->most + to] = rows->all[i * rows->most + from];
}

CT_INLINE void write_four(const columns c)
{
  for (int g = 0; g < WRITE; g++) {
    const double *from[4];
    double *to[4];
    for (int i = 0; i < 4; i++) {
      from[i] = c.first + ((int64_t)WRITES[g][1] + i) * c.most;
      to[i] = c.row[i] + WRITES[g][0];
    }
    ct_turn(from, to);
  }
  for (int i = 0; i < 4; i++) c.row[i][AT(impact.release)] = c.first[RELEASE * c.most + i];
}

CT_INLINE void write_one(const columns c)
{
  for (int g = 0; g < WRITE; g++)
    for (int i = 0; i < 4; i++)
      c.row[0][WRITES[g][0] + (size_t)i] = c.first[((int64_t)WRITES[g][1] + i) * c.most];
  c.row[0][AT(impact.release)] = c.first[RELEASE * c.most];
}

CT_CLONES
void ct_law_rows_write(const ct_law_rows *from)
{
  const int64_t count = from->count;
  int64_t r = 0;
  for (; r + 4 <= count; r += 4) write_four(columns_of(from, r, 4));
  for (; r < count; r++) write_one(columns_of(from, r, 1));
}
