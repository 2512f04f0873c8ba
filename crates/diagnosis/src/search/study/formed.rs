//! The inner products of a study, formed once for each table, and once for each background.

use std::sync::{Arc, Mutex, PoisonError};

use super::Study;
use crate::regression::fit::Products;
use crate::regression::strengths::PriorStrengths;

/// The number of backgrounds whose products are stored.
const KEPT: usize = 64;

/// Products that are valid for the present table and prior.
#[derive(Debug, Default)]
pub struct Formed(Mutex<List>);

/// The products over the training recordings and over the held-out ones.
#[derive(Debug, Default)]
struct List {
    /// The table and the prior that they are of.
    of: Option<[Arc<()>; 2]>,
    /// Without background, each with the origin of the table that it is of, which may have fewer columns than the present one.
    bare: [Option<(Arc<()>, Products)>; 2],
    /// Whether they have all columns of the present table.
    is_whole: [bool; 2],
    /// With the backgrounds that were requested last.
    with_background: Vec<(bool, PriorStrengths, Products)>,
}

impl List {
    /// Forgets what is of another table or prior.
    fn renew(&mut self, table: &Arc<()>, prior: &Arc<()>) {
        let is_same =
            |[own_table, own_prior]: &[Arc<()>; 2]| [Arc::ptr_eq(own_table, table), Arc::ptr_eq(own_prior, prior)];
        let [same_table, same_prior] = self.of.as_ref().map_or([false; 2], is_same);
        if !same_table {
            self.is_whole = [false; 2];
        }
        if !same_table || !same_prior {
            self.with_background.clear();
            self.of = Some([Arc::clone(table), Arc::clone(prior)]);
        }
    }
}

impl Study {
    /// Inner products over the recordings to be fitted.
    pub fn training_products(&self) -> Products {
        self.formed(false, &self.strengths)
    }

    /// Inner products over the held-out recordings; `None` if there are none.
    pub fn held_products(&self) -> Option<Products> {
        let has_held_out = self.data.fitted.contains(&false);
        has_held_out.then(|| self.formed(true, &self.strengths))
    }

    /// Inner products over the training recordings, with a background of other strengths.
    pub fn products_at(&self, strengths: &PriorStrengths) -> Products {
        self.formed(false, strengths)
    }

    fn formed(&self, held_out: bool, strengths: &PriorStrengths) -> Products {
        let known = |list: &mut List| {
            list.renew(self.table.identity(), self.prior.identity());
            let is_same = |(held, with, _): &&(bool, PriorStrengths, Products)| (*held, with) == (held_out, strengths);
            list.with_background.iter().find(is_same).map(|(.., products)| products.clone())
        };
        if let Some(products) = self.stored(known) {
            return products;
        }
        // They are formed without the lock, so that no thread waits, and are the same from every thread.
        let bare = self.bare(held_out).remembering(&self.memory);
        let products = bare.with_background(self.prior.at(strengths));
        self.stored(|list| {
            if list.with_background.len() == KEPT {
                list.with_background.remove(0);
            }
            list.with_background.push((held_out, strengths.clone(), products.clone()));
        });
        products
    }

    fn bare(&self, held_out: bool) -> Products {
        let place = usize::from(held_out);
        let known = self.stored(|list| list.bare[place].clone().map(|known| (list.is_whole[place], known)));
        let is_same = |of: &Arc<()>| Arc::ptr_eq(of, self.table.origin());
        let products = match known {
            Some((true, (_, products))) => return products,
            Some((false, (of, products))) if is_same(&of) => products.with_columns_added(&self.table),
            _ => self.bare_products(&self.table, held_out),
        };
        self.stored(|list| {
            list.bare[place] = Some((Arc::clone(self.table.origin()), products.clone()));
            list.is_whole[place] = true;
        });
        products
    }

    /// Forgets the products with a background, after what the rows are worth has changed.
    pub(super) fn forget_backgrounds(&self) {
        self.stored(|list| list.with_background.clear());
    }

    fn stored<T>(&self, with: impl FnOnce(&mut List) -> T) -> T {
        with(&mut self.formed.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
